"""Reads the folder, configuration and gradebook of a class, and writes the gradebook."""
