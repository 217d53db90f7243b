"""One notebook of one student, ready to be executed anywhere; and the points for the verdicts on it."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping  # noqa: TC003  (msgspec reads the annotations)
from dataclasses import dataclass, field, replace

import msgspec

from autograder.boxes.limits import Limits
from autograder.execution.cells import Cell, CellCheck, Execution
from autograder.execution.verdicts_without_judge import grader_trouble, zero_points
from autograder.verdict import State, Verdict

UNREADABLE = "unreadable"
"""The diagnosis for a submission that is not a notebook."""


@dataclass(frozen=True)
class Task:
    """A task for a worker. It contains everything that the worker needs, and nothing else.

    Attributes:
        student: The student's id, for messages.
        assignment: The assignment's name.
        notebook: The notebook's name.
        cells: The cells of the rebuilt notebook.
        seed: The seed of the judge's random inputs.
        course: A hash of everything in the course that influences a grade.
        limits: The limits on time, memory and output.
        files: The assignment's files next to the notebook, by relative path.
        problem: Why nothing can be executed; empty if the notebook can be executed.
        remarks: Sentences about repairs of the notebook.
        pictures: A hash of the pictures that the student attached. With other pictures it counts as other work.
        boxed: True to execute the notebook only in boxes. False for the course's own notebooks, or if the instructor
            asked for it; such a result never counts as one from a box.
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
        """Return the task with its memory limit: a share of the memory if other tasks run, else all of the memory."""
        return replace(self, limits=replace(self.limits, beside=beside))

    @property
    def label(self) -> str:
        """Return the name of the task for messages."""
        return f"{self.student}/{self.assignment}/{self.notebook}"

    def key(self) -> str:
        """Return a hash of everything on which the execution depends. Tasks with equal hashes have the same result."""
        return hashlib.sha256(msgspec.json.encode(self, order="deterministic")).hexdigest()

    def without_execution(self) -> Execution:
        """Return the result of a task with a problem: no cell is run, and each check gets zero and the reason."""
        verdicts = {
            index: zero_points(
                cell.check, UNREADABLE, self.problem, "Hand in the notebook as JupyterLab saves it."
            )
            for index, cell in enumerate(self.cells)
            if cell.check is not None
        }
        return Execution(cells=(), verdicts=verdicts)

    def in_trouble(self, reason: str) -> Execution:
        """Return the result of a task that the grader could not execute, which is not the student's fault.

        Args:
            reason: Why the task could not be executed.
        """
        verdicts = {
            index: grader_trouble(cell.check, reason) for index, cell in enumerate(self.cells) if cell.check
        }
        return Execution(cells=(), verdicts=verdicts, trouble=reason)


def points(check: CellCheck, verdict: Verdict) -> float:
    """Return the points for a verdict: the cell's points times the share that the judge gave."""
    share = verdict.score / verdict.max_score if verdict.max_score > 0 else 0.0
    return round(min(1.0, max(0.0, share)) * check.worth, 4)


def scores_of(task: Task, execution: Execution) -> dict[str, float]:
    """Return the points of each check cell of a task, by grade_id."""
    return {
        cell.name: points(cell.check, execution.verdicts[index])
        for index, cell in enumerate(task.cells)
        if cell.check is not None
    }


def unchecked(task: Task, execution: Execution) -> set[str]:
    """Return the check cells of a task that could not be checked, by grade_id."""
    return {
        cell.name
        for index, cell in enumerate(task.cells)
        if cell.check is not None and execution.verdicts[index].state == State.NOT_CHECKED
    }
