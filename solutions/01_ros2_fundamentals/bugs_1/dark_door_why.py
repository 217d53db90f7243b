"""The question on the cause, which is in dark_door.ticket.toml, too."""

from autograder.kit import question

EXERCISE = question(__file__)
