"""The question on the cause: its words are in lost_porter.ticket.toml."""

from autograder.kit import question

EXERCISE = question(__file__)
