"""The question on the cause: its words are in night_lamp.ticket.toml."""

from autograder.kit import question

EXERCISE = question(__file__)
