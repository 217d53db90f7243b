"""What came of grading a class: rows, a table for a person, a CSV file for everything else."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from autograder.grading.journal import write_whole
from autograder.grading.points import points
from autograder.grading.spreadsheet import csv_text
from autograder.grading.timings import Timings
from autograder.verdict import State

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from autograder.boxes.execution import Execution
    from autograder.grading.class_directory import Refused
    from autograder.grading.task import Task

NOT_SUBMITTED = "not_submitted"
NOT_GRADED = "not_graded"
"""Handed in, but left out of every run so far."""
COLUMNS = ("student", "assignment", "exercise", "score", "max", "state", "diagnosis", "reason")


@dataclass(frozen=True)
class Row:
    """One student's result in one exercise.

    Attributes:
        student: The student's id.
        assignment: The assignment's name.
        exercise: The exercise's id.
        score: Points in the gradebook.
        max_score: Points that can be had.
        state: ``passed``, ``failed``, ``not_checked``, ``not_graded`` or ``not_submitted``.
        diagnosis: The key of the mistake, empty for none.
        reason: Its text, empty for none.
    """

    student: str
    assignment: str
    exercise: str
    score: float
    max_score: float
    state: str
    diagnosis: str = ""
    reason: str = ""


@dataclass(frozen=True)
class GradeReport:
    """What came of a batch.

    Attributes:
        path: The class.
        rows: By student, in the order of the course.
        refused: What lies in ``submitted`` and cannot be graded under that name.
        problems: What else went wrong, each a sentence; none of it earned anybody points.
        executed: Notebooks that were run.
        reused: Notebooks whose result was known.
        written: Submissions entered into the gradebook in this run.
        seconds: Wall time.
        timings: Where it went.
    """

    path: Path
    rows: tuple[Row, ...]
    refused: tuple[Refused, ...] = ()
    problems: tuple[str, ...] = ()
    executed: int = 0
    reused: int = 0
    written: int = 0
    seconds: float = 0.0
    timings: Timings = field(default_factory=Timings)

    @property
    def note(self) -> str:
        """What whoever reads the points has to know about how they came about; mostly empty."""
        from autograder.grading import sandboxing

        return sandboxing.note(self.path)

    @property
    def gradebook(self) -> Path:
        """Nbgrader's gradebook."""
        return self.path / "gradebook.db"

    @property
    def csv(self) -> Path:
        """The file of all rows."""
        return self.path / "grades.csv"

    @property
    def feedback(self) -> Path:
        """The folder of pages that go back to the students."""
        return self.path / "feedback"

    @property
    def exit_code(self) -> int:
        """0 when everything was graded; 2 when something could not be checked or could not be taken."""
        unchecked = any(row.state == State.NOT_CHECKED for row in self.rows)
        return 2 if self.refused or self.problems or unchecked else 0


def rows_of(task: Task, execution: Execution) -> list[Row]:
    """The rows of one notebook."""
    found = []
    for index, cell in enumerate(task.cells):
        if cell.check is None:
            continue
        verdict = execution.verdicts[index]
        diagnosis = verdict.diagnosis
        found.append(
            Row(
                student=task.student,
                assignment=task.assignment,
                exercise=cell.check.exercise,
                score=points(cell.check, verdict),
                max_score=cell.check.worth,
                state=str(verdict.state),
                diagnosis=diagnosis.key if diagnosis else "",
                reason=diagnosis.text if diagnosis else "",
            )
        )
    return found


def write_csv(path: Path, rows: Iterable[Row]) -> None:
    """Write the rows as UTF-8 CSV, replacing the file as a whole.

    Raises:
        OSError: It could not be written; an earlier file is still there then.
    """
    write_whole(path, csv_text([COLUMNS, *map(_cells, rows)]).encode())


def _cells(row: Row) -> tuple[str | float, ...]:
    who = (row.student, row.assignment, row.exercise)
    return (*who, row.score, row.max_score, row.state, row.diagnosis, row.reason)
