"""The lost guide, which students repair. Its words are in lost_guide.ticket.toml."""

from autograder.kit import repair

EXERCISE = repair(__file__)
