"""The question on the cause of a ticket, whose words are in the file next to this one."""

from autograder.kit.hunts.ticket import question

EXERCISE = question(__file__)
