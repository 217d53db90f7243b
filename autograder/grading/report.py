"""What came of grading a class: rows, a table for a person, a CSV file for everything else."""

from __future__ import annotations

import csv
import io
from dataclasses import dataclass
from typing import TYPE_CHECKING

from rich.table import Table
from rich.text import Text

from autograder.grading.journal import write_whole
from autograder.grading.points import points
from autograder.verdict import State

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from pathlib import Path

    from autograder.boxes.execution import Execution
    from autograder.grading.class_directory import Refused
    from autograder.grading.task import Task

NOT_SUBMITTED = "not_submitted"
COLUMNS = ("student", "assignment", "exercise", "score", "max", "state", "diagnosis", "reason")
_DANGEROUS = ("=", "+", "-", "@", "\t", "\r")


@dataclass(frozen=True)
class Row:
    """One student's result in one exercise.

    Attributes:
        student: The student's id.
        assignment: The assignment's name.
        exercise: The exercise's id.
        score: Points in the gradebook.
        max_score: Points that can be had.
        state: ``passed``, ``failed``, ``not_checked`` or ``not_submitted``.
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
    """

    path: Path
    rows: tuple[Row, ...]
    refused: tuple[Refused, ...] = ()
    problems: tuple[str, ...] = ()
    executed: int = 0
    reused: int = 0
    written: int = 0
    seconds: float = 0.0

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
    text = io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    for row in rows:
        words = (row.student, row.assignment, row.exercise)
        numbers = (f"{row.score:g}", f"{row.max_score:g}")
        writer.writerow(
            [*map(_defused, words), *numbers, *map(_defused, (row.state, row.diagnosis, row.reason))]
        )
    write_whole(path, text.getvalue().encode())


def table(rows: Sequence[Row]) -> Table:
    """Students down, exercises across: points, and the diagnosis where some are missing."""
    exercises = list(dict.fromkeys(row.exercise for row in rows))
    results = {(row.student, row.exercise): row for row in rows}
    shown = Table(title=None, header_style="bold", pad_edge=False)
    shown.add_column("student", no_wrap=True)
    for exercise in exercises:
        shown.add_column(exercise)
    shown.add_column("total", justify="right", no_wrap=True)
    for student in dict.fromkeys(row.student for row in rows):
        own = [results.get((student, exercise)) for exercise in exercises]
        total = sum(row.score for row in own if row)
        most = sum(row.max_score for row in own if row)
        shown.add_row(Text(printable(student)), *map(_cell, own), f"{total:g}/{most:g}")
    return shown


def printable(text: str) -> str:
    """``text`` with whatever could forge a line or move the cursor shown as an escape."""
    return "".join(
        c if c.isprintable() else c.encode("unicode_escape", "surrogatepass").decode() for c in text
    )


def _cell(row: Row | None) -> Text:
    if row is None or row.state == NOT_SUBMITTED:
        return Text("–", style="dim")
    style = {State.PASSED: "green", State.FAILED: "red", State.NOT_CHECKED: "yellow"}.get(
        State(row.state), ""
    )
    text = Text(f"{row.score:g}/{row.max_score:g}", style=style)
    if row.diagnosis:
        text.append(f" {row.diagnosis}", style="default")
    return text


def _defused(text: str) -> str:
    """A cell that a spreadsheet will not take for a formula (OWASP, "CSV Injection")."""
    text = text.replace("\0", "")
    return f"'{text}" if text.lstrip(" \n").startswith(_DANGEROUS) else text
