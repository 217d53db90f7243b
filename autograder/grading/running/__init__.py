"""Executes tasks in parallel, with worker processes, boxes and fork servers."""
