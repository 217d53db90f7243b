"""The still robot, which students repair. Its words are in still_robot.ticket.toml."""

from autograder.kit.hunts.ticket import repair

EXERCISE = repair(__file__)
