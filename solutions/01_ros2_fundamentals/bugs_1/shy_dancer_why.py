"""The question on the cause, which is in shy_dancer.ticket.toml, too."""

from autograder.kit import question

EXERCISE = question(__file__)
