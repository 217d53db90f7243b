"""The question on the cause, which is in still_robot.ticket.toml, too."""

from autograder.kit import question

EXERCISE = question(__file__)
