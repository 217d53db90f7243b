"""The question on the cause: its words are in offended_dock.ticket.toml."""

from autograder.kit import question

EXERCISE = question(__file__)
