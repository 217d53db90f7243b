"""A broken program that students repair. The words of this ticket are in the file next to this one."""

from autograder.kit import repair

EXERCISE = repair(__file__)
