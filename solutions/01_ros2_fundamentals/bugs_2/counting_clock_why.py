"""The question on the cause: its words are in counting_clock.ticket.toml."""

from autograder.kit import question

EXERCISE = question(__file__)
