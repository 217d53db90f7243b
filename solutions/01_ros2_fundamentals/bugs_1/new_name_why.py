"""The question on the cause, which is in new_name.ticket.toml, too."""

from autograder.kit import question

EXERCISE = question(__file__)
