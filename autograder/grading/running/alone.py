"""The rule for what says nothing: it is executed once more with nothing beside it, and then it counts."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from autograder.boxes.execution import Execution
    from autograder.grading.task import Task


def says_nothing(execution: Execution) -> bool:
    """True if it is to be executed once more, alone: others have perhaps used up what it was short of."""
    return bool(execution.trouble) or execution.crowded_out


def ordered(task: Task, *, beside: bool) -> Task:
    """The task as a worker gets it: with its share of memory where others are beside it, else with all limits."""
    return replace(task, limits=replace(task.limits, beside=beside))
