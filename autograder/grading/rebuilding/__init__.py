"""Reads a submitted notebook in a box, compares it with the trusted master, and builds a new notebook."""
