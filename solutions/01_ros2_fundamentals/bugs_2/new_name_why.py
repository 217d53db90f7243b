"""The question on the cause: its words are in new_name.ticket.toml."""

from autograder.kit.hunts.ticket import question

EXERCISE = question(__file__)
