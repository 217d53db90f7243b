"""The question on the cause: its words are in quiet_morning.ticket.toml."""

from autograder.kit.hunts.ticket import question

EXERCISE = question(__file__)
