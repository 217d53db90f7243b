"""The quiet greeter, which students repair. Its words are in quiet_greeter.ticket.toml."""

from autograder.kit import repair

EXERCISE = repair(__file__)
