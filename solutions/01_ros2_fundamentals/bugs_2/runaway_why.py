"""The question on the cause: its words are in runaway.ticket.toml."""

from autograder.kit.hunts.ticket import question

EXERCISE = question(__file__)
