"""The shy dancer, which students repair. Its words are in shy_dancer.ticket.toml."""

from autograder.kit import repair

EXERCISE = repair(__file__)
