"""Runs a notebook cell by cell: the kernel, the desk that reads it, and what each cell came to. Boxes isolate it."""
