"""Reads what is collected: archives, lists from an LMS, and the names of files."""
