"""The question on the cause: its words are in second_time.ticket.toml."""

from autograder.kit import question

EXERCISE = question(__file__)
