"""Decides whose a collected file is, for which notebook, and which file of a student counts."""
