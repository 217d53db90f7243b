"""The subject of a check, seen from the judge: something in a notebook, a command, or a path."""
