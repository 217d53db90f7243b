"""Executes tasks in parallel, by worker processes with boxes and fork servers."""
