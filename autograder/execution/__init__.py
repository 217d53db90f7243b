"""Runs a notebook cell by cell: its kernel, the desk that reads the kernel's messages, and the result of each cell."""
