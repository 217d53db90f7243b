"""Reads the output of a subject: its own words, and the lines with which a runner reports."""
