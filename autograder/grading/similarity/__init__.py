"""Finds pairs of submissions that are more similar than their task explains, as hints that a person has to judge."""
