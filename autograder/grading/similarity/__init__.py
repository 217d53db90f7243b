"""Pairs of submissions that are more similar than the task explains: a hint for a person, never a grade."""
