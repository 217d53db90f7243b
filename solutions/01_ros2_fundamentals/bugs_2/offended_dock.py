"""A ticket of the bug hunt: its words are in offended_dock.ticket.toml."""

from autograder.kit import repair

EXERCISE = repair(__file__)
