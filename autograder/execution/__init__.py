"""Executing the course's notebooks: masters earn full marks, chapters reach their end and earn nothing."""

from autograder.execution.execute_command import execute_command
from autograder.execution.plan import NothingToExecuteError

__all__ = ["NothingToExecuteError", "execute_command"]
