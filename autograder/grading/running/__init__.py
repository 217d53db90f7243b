"""Tasks executed, as many at once as the machine bears, by worker processes with boxes and fork servers."""
