"""The still robot, which students repair. Its words are in still_robot.ticket.toml."""

from autograder.kit import repair

EXERCISE = repair(__file__)
