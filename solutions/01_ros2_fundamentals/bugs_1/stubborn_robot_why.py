"""The question on the cause, which is in stubborn_robot.ticket.toml, too."""

from autograder.kit import question

EXERCISE = question(__file__)
