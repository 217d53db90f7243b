"""The stubborn robot, which students repair. Its words are in stubborn_robot.ticket.toml."""

from autograder.kit.hunts.ticket import repair

EXERCISE = repair(__file__)
