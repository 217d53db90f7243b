"""The question on the cause of a ticket, whose words are in the file next to this one."""

from autograder.kit import question

EXERCISE = question(__file__)
