"""One notebook of one student, ready to be executed anywhere, and the points that its verdicts are worth."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping  # noqa: TC003  (msgspec reads the annotations)
from dataclasses import dataclass, field, replace

import msgspec

from autograder.boxes.execution import Cell, Check, Execution
from autograder.boxes.limits import Limits
from autograder.boxes.verdicts_without_judge import grader_trouble, zero_points
from autograder.verdict import State, Verdict

UNREADABLE = "unreadable"
"""The diagnosis of what was handed in and is no notebook."""


@dataclass(frozen=True)
class Task:
    """A task for a worker: what it needs to know, and nothing else.

    Attributes:
        student: The student's id, for messages.
        assignment: The assignment's name.
        notebook: The notebook's name.
        cells: The rebuilt notebook.
        seed: The seed of the judge's random inputs.
        course: Stands for the version of everything that decides a grade.
        limits: All limits.
        files: Files of the assignment that are beside the notebook, by relative path.
        problem: Why there is nothing to execute; empty for a notebook that can be.
        remarks: Sentences on what was put right in the notebook.
        pictures: Stands for the pictures that the student has attached: work with others is other work.
        boxed: Execute in boxes, or not at all. False is for the course's own notebooks, and for an instructor who has
            typed so; such a result never counts as one from a box.
    """

    student: str
    assignment: str
    notebook: str
    cells: tuple[Cell, ...]
    seed: str
    course: str
    limits: Limits = field(default_factory=Limits)
    files: Mapping[str, bytes] = field(default_factory=dict)
    problem: str = ""
    remarks: tuple[str, ...] = ()
    pictures: str = ""
    boxed: bool = True

    def beside_others(self, beside: bool) -> Task:
        """The task as a worker gets it: with its share of memory where others are beside it, else with all limits."""
        return replace(self, limits=replace(self.limits, beside=beside))

    @property
    def label(self) -> str:
        """The name of the task in messages."""
        return f"{self.student}/{self.assignment}/{self.notebook}"

    def key(self) -> str:
        """A hash of everything that the execution depends on: equal for two tasks with the same result."""
        return hashlib.sha256(msgspec.json.encode(self, order="deterministic")).hexdigest()

    def without_execution(self) -> Execution:
        """The result of a task with a problem: no cell runs, every check is zero with the reason."""
        verdicts = {
            index: zero_points(
                cell.check, UNREADABLE, self.problem, "Hand in the notebook as JupyterLab saves it."
            )
            for index, cell in enumerate(self.cells)
            if cell.check is not None
        }
        return Execution(cells=(), verdicts=verdicts)

    def in_trouble(self, reason: str) -> Execution:
        """The result of a task that the grader could not execute: no cell runs, no check is anyone's fault.

        Args:
            reason: Why it could not.
        """
        verdicts = {
            index: grader_trouble(cell.check, reason) for index, cell in enumerate(self.cells) if cell.check
        }
        return Execution(cells=(), verdicts=verdicts, trouble=reason)


def points(check: Check, verdict: Verdict) -> float:
    """The points that a verdict is worth: the judge's share of what the cell carries."""
    share = verdict.score / verdict.max_score if verdict.max_score > 0 else 0.0
    return round(min(1.0, max(0.0, share)) * check.worth, 4)


def scores_of(task: Task, execution: Execution) -> dict[str, float]:
    """The points of each check cell of a task, by grade_id."""
    return {
        cell.name: points(cell.check, execution.verdicts[index])
        for index, cell in enumerate(task.cells)
        if cell.check is not None
    }


def unchecked(task: Task, execution: Execution) -> set[str]:
    """The check cells of a task that could not be checked, by grade_id."""
    return {
        cell.name
        for index, cell in enumerate(task.cells)
        if cell.check is not None and execution.verdicts[index].state == State.NOT_CHECKED
    }
