"""Finds pairs of submissions that are more similar than their task explains. A pair is a hint for a person."""
