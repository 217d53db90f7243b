"""A ticket of the bug hunt: its words are in lost_porter.ticket.toml."""

from autograder.kit import repair

EXERCISE = repair(__file__)
