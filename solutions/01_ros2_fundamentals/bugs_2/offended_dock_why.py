"""The question on the cause: its words are in offended_dock.ticket.toml."""

from autograder.kit.hunts.ticket import question

EXERCISE = question(__file__)
