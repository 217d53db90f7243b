"""The stubborn robot, which students repair. Its words are in stubborn_robot.ticket.toml."""

from autograder.kit import repair

EXERCISE = repair(__file__)
