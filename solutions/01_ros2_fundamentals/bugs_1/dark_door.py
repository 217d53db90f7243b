"""The dark door, which students repair. Its words are in dark_door.ticket.toml."""

from autograder.kit import repair

EXERCISE = repair(__file__)
