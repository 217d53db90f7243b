"""The question on the cause, which is in quiet_greeter.ticket.toml, too."""

from autograder.kit import question

EXERCISE = question(__file__)
