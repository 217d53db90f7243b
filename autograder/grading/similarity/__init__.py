"""Pairs of submissions that are closer to each other than the task explains: a hint for a person, never a grade."""
