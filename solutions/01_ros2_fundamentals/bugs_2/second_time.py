"""A ticket of the bug hunt: its words are in second_time.ticket.toml."""

from autograder.kit import repair

EXERCISE = repair(__file__)
