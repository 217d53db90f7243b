"""The new name, which students repair. Its words are in new_name.ticket.toml."""

from autograder.kit import repair

EXERCISE = repair(__file__)
