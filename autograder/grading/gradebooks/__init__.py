"""Reads nbgrader's gradebook, and writes results into it, with one class (``Writer``) for all writing."""
