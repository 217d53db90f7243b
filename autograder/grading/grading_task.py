"""Defines a task (one notebook of one student, ready to be executed), and computes the points from its verdicts."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping  # noqa: TC003  (msgspec reads the annotations)
from dataclasses import dataclass, field, replace

import msgspec

from autograder.boxes.run_limits import Limits
from autograder.execution.executed_cells import Cell, CellCheck, Execution
from autograder.execution.verdicts_without_judge import grader_trouble, zero_points
from autograder.verdict import State, Verdict

UNREADABLE = "unreadable"
"""The diagnosis for a submission that is not a notebook."""


@dataclass(frozen=True)
class Task:
    """A notebook to execute, with everything that a worker needs for it.

    Attributes:
        student: The student's id, for messages.
        cells: The cells of the rebuilt notebook.
        seed: The seed of the judge's random inputs.
        course: The version of the course: a hash of the code that executes the notebook, and of its exercises.
        limits: The limits on time, memory and output.
        files: The assignment's files next to the notebook, by relative path.
        problem: The reason if the notebook cannot be executed; otherwise empty.
        remarks: Sentences about repairs of the notebook.
        pictures: A hash of the pictures that the student attached, so that changed pictures change the task's hash.
        drawings: For each exercise that draws its inputs, the recording of the class's drawing that this submission
            gets, as JSON; empty if it could not be recorded, so that the exercise cannot be checked.
        records: For the solution of an exercise, the name of the drawing to record; empty for a submission.
        boxed: True to execute the notebook in a sandbox; False for the course's own notebooks, and if the instructor
            allowed grading without a sandbox. A result without a sandbox is not reused for a boxed task, because the
            two have different hashes.
        overlays: The paths of the workspaces that the class names. They change the task's hash; a worker learns them
            when it starts.
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
    drawings: Mapping[str, str] = field(default_factory=dict)
    records: str = ""
    boxed: bool = True
    overlays: tuple[str, ...] = ()

    def beside_others(self, beside: bool) -> Task:
        """Return the task with the memory limit for running beside other tasks, or alone if ``beside`` is False."""
        return replace(self, limits=replace(self.limits, beside=beside))

    @property
    def label(self) -> str:
        """The name of the task in messages, such as ``ada/lab_1_2/lab_1_2``."""
        return f"{self.student}/{self.assignment}/{self.notebook}"

    def key(self) -> str:
        """Return a hash of the whole task: tasks with the same hash have the same result."""
        return hashlib.sha256(msgspec.json.encode(self, order="deterministic")).hexdigest()

    @property
    def checks(self) -> dict[int, CellCheck]:
        """The checks of the notebook, by the index of their cell."""
        return {index: cell.check for index, cell in enumerate(self.cells) if cell.check is not None}

    def without_execution(self) -> Execution:
        """Return the result of a task that cannot be executed: no cell is run, and each check gets zero points."""
        advice = "Hand in the notebook as JupyterLab saves it."
        verdicts = {
            index: zero_points(check, UNREADABLE, self.problem, advice)
            for index, check in self.checks.items()
        }
        return Execution(cells=(), verdicts=verdicts)

    def in_trouble(self, reason: str) -> Execution:
        """Return the result of a task that was not executed because the grader failed: no check was made.

        Args:
            reason: Why the grader failed.
        """
        verdicts = {index: grader_trouble(check, reason) for index, check in self.checks.items()}
        return Execution(cells=(), verdicts=verdicts, trouble=reason)


@dataclass(frozen=True)
class GradedCell:
    """A cell with points in a source notebook.

    Attributes:
        name: The grade_id of the cell.
        exercise: The id of the exercise that the cell checks; if there is none, the name of the cell.
        worth: The maximum points of the cell.
        by_judge: True if the judge or the cell's own tests give the points; False if a person does.
    """

    notebook: str
    name: str
    exercise: str
    worth: float
    by_judge: bool = True


def points(check: CellCheck, verdict: Verdict) -> float:
    """Return the points for a verdict: the points of the check cell times the share that the judge gave."""
    share = verdict.score / verdict.max_score if verdict.max_score > 0 else 0.0
    return round(min(1.0, max(0.0, share)) * check.worth, 4)


def scores_of(task: Task, execution: Execution) -> dict[str, float]:
    """Return the points of each check cell of a task, by grade_id."""
    return {
        task.cells[index].name: points(check, execution.verdicts[index])
        for index, check in task.checks.items()
    }


def unchecked(task: Task, execution: Execution) -> set[str]:
    """Return the grade_ids of the check cells that could not be checked."""
    states = {task.cells[index].name: execution.verdicts[index].state for index in task.checks}
    return {name for name, state in states.items() if state == State.NOT_CHECKED}
