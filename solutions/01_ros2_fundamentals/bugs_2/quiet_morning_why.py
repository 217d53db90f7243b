"""The question on the cause: its words are in quiet_morning.ticket.toml."""

from autograder.kit import question

EXERCISE = question(__file__)
