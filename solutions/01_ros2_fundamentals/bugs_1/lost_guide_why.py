"""The question on the cause, which is in lost_guide.ticket.toml, too."""

from autograder.kit import question

EXERCISE = question(__file__)
