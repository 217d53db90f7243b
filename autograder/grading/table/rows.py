"""Defines a row, the result of one student in one exercise, and writes rows into ``grades.csv``."""

from __future__ import annotations

from collections import Counter
from collections.abc import Hashable
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeVar

from autograder.cards.readable_text import one_line
from autograder.grading.grading_task import points
from autograder.grading.table.spreadsheet_csv import blank, csv_text
from autograder.safe_files import write_whole
from autograder.verdict import State

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping
    from pathlib import Path

    from autograder.execution.executed_cells import Execution
    from autograder.grading.grading_task import Task


NOT_SUBMITTED = "not_submitted"
NOT_GRADED = "not_graded"
"""The state of an exercise that was submitted, but not graded yet."""
WAITS = "waits"
"""The state of a cell that a person still has to grade."""
BY_HAND = "by_hand"
"""The state of a cell to which a person has given points."""
EXCUSED = "excused"
"""The state of an exercise if students.csv excuses the student from its assignment, so that it does not count in the
total.
"""
LATE = "late"
"""The value of ``exercise`` in a row for a late penalty."""
DROPPED = "dropped"
"""The value of ``exercise`` in a row that subtracts the points of a dropped assignment."""
NO_EXERCISE = (LATE, DROPPED)
NOTHING_JUDGED = (NOT_SUBMITTED, NOT_GRADED, EXCUSED, State.NOT_CHECKED)
"""The states in which the judge gave no points."""
_Key = TypeVar("_Key", bound=Hashable)
_Of = TypeVar("_Of")


@dataclass(frozen=True)
class Row:
    """The result of one student in one exercise.

    Attributes:
        student: The student's id.
        exercise: The exercise's id, or the name of a cell that a person grades. In a row that subtracts points for
            lateness it is ``late``, and in one that subtracts those of a dropped assignment ``dropped``.
        score: The points in the gradebook, including those that a person gave.
        max_score: The maximum points for the exercise.
        state: ``passed``, ``failed``, ``not_checked``, ``not_graded``, ``not_submitted``, ``excused``, ``waits``,
            ``by_hand``, ``late`` or ``dropped``.
        diagnosis: The key of the recognized mistake; empty if there is none.
        reason: The text about the mistake; empty if there is none.
        judged: The automatic points in the gradebook; None if there are none.
        by_hand: The points by a person, which replace the automatic points; None if there are none.
        extra: Extra credit: points that a person added.
        waits: True if a person still has to grade the exercise.
        name: The student's name; empty if unknown.
        remarks: Sentences about repairs of the notebook, such as missing cells that were put back.
    """

    student: str
    assignment: str
    exercise: str
    score: float
    max_score: float
    state: str
    diagnosis: str = ""
    reason: str = ""
    judged: float | None = None
    by_hand: float | None = None
    extra: float = 0.0
    waits: bool = False
    name: str = ""
    remarks: tuple[str, ...] = ()

    @property
    def is_blank(self) -> bool:
        """True if the row has no points yet, which is different from zero points."""
        return self.state in NOTHING_JUDGED and self.by_hand is None and not self.extra

    @property
    def is_unchecked(self) -> bool:
        """True if the exercise was submitted but could not be judged yet; the next run may give points."""
        return self.is_blank and self.state in (NOT_GRADED, State.NOT_CHECKED)

    @property
    def is_to_come(self) -> bool:
        """True if the next run or a person still has to give points."""
        return self.is_unchecked or self.state == WAITS

    @property
    def shown_score(self) -> float | None:
        """The points; None if the row has no points yet."""
        return None if self.is_blank else self.score

    @property
    def mark(self) -> str:
        """The mark after the points: ``?`` if a person still has to grade, ``*`` if a person gave points, or empty."""
        return "?" if self.waits else "*" if self.by_hand is not None or self.extra else ""


def rows_of(task: Task, execution: Execution) -> list[Row]:
    """Return a row for each check of an executed notebook."""
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
                remarks=task.remarks,
            )
        )
    return found


def grouped(rows: Iterable[_Of], key: Callable[[_Of], _Key]) -> dict[_Key, list[_Of]]:
    """Return rows, or other results, by a key such as the student, in the order of the rows."""
    found: dict[_Key, list[_Of]] = {}
    for row in rows:
        found.setdefault(key(row), []).append(row)
    return found


def total(rows: Iterable[Row]) -> float | None:
    """Return the sum of the points in some rows; None if no row has points yet."""
    scores = [score for row in rows if (score := row.shown_score) is not None]
    return round(sum(scores), 4) if scores else None


def columns(rows: Iterable[Row]) -> dict[tuple[str, str], str]:
    """Return the heading of each exercise's column, by assignment and exercise.

    If several assignments have a cell with the same name, the heading begins with the assignment's name.
    """
    keys = list(
        dict.fromkeys((row.assignment, row.exercise) for row in rows if row.exercise not in NO_EXERCISE)
    )
    often = Counter(exercise for _, exercise in keys)
    return {key: key[1] if often[key[1]] == 1 else ".".join(key) for key in keys}


_LONGEST_REMARKS = 600


def remarks_on(rows: Iterable[Row]) -> dict[tuple[str, str], str]:
    """Return the remarks on each submission in one line, by student and assignment."""
    found: dict[tuple[str, str], dict[str, None]] = {}
    for row in rows:
        found.setdefault((row.student, row.assignment), {}).update(dict.fromkeys(row.remarks))
    return {key: one_line(" ".join(remarks), _LONGEST_REMARKS) for key, remarks in found.items() if remarks}


COLUMNS: Mapping[str, Callable[[Row], str | float]] = {
    "student": lambda row: row.student,
    "assignment": lambda row: row.assignment,
    "exercise": lambda row: row.exercise,
    "score": lambda row: blank(row.shown_score),
    "max": lambda row: row.max_score,
    "state": lambda row: row.state,
    "diagnosis": lambda row: row.diagnosis,
    "reason": lambda row: row.reason,
    "judge": lambda row: blank(row.judged),
    "by_hand": lambda row: blank(row.by_hand),
    "extra": lambda row: row.extra or "",
    "waits_for_a_person": lambda row: "yes" if row.waits else "",
    "name": lambda row: row.name,
}
"""The columns of a table of results, each with its value in a row."""


def write_csv(path: Path, rows: Iterable[Row]) -> None:
    """Write rows as a CSV file, in UTF-8 with a byte order mark (BOM), so that Excel recognizes the encoding.

    Raises:
        OSError: The file could not be written. If it existed before, it is unchanged.
    """
    write_whole(path, csv_text([COLUMNS, *map(csv_cells, rows)]).encode("utf-8-sig"))


def csv_cells(row: Row) -> list[str | float]:
    """Return the values of a row in the order of :data:`COLUMNS`."""
    return [value(row) for value in COLUMNS.values()]
