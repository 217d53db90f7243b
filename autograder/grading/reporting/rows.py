"""The rows of a class's results, and the CSV file of them: ``grades.csv``."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING

from autograder.cards.readable import one_line
from autograder.grading.reporting.spreadsheet import csv_text
from autograder.grading.task import points
from autograder.regular_files import write_whole
from autograder.verdict import State

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from autograder.boxes.execution import Execution
    from autograder.grading.task import Task

NOT_SUBMITTED = "not_submitted"
NOT_GRADED = "not_graded"
"""Handed in, but left out of each run so far."""
WAITS = "waits"
"""A cell that a person gives points for, and that has none yet."""
BY_HAND = "by_hand"
"""A cell that a person has given points for."""
EXCUSED = "excused"
"""The student need not do the assignment, as students.csv says: it counts neither for nor against anybody."""
LATE = "late"
"""Stands in place of the exercise in the row with the points that are taken off for being late."""
DROPPED = "dropped"
"""Stands there in the row that takes one of a student's lowest assignments out of the total, and of nothing else."""
NO_EXERCISE = (LATE, DROPPED)
COLUMNS = (
    "student",
    "assignment",
    "exercise",
    "score",
    "max",
    "state",
    "diagnosis",
    "reason",
    "judge",
    "by_hand",
    "extra",
    "waits_for_a_person",
    "name",
)


_LONGEST_REMARKS = 600
_NOTHING_JUDGED = (NOT_SUBMITTED, NOT_GRADED, EXCUSED, State.NOT_CHECKED)


def total(rows: Iterable[Row]) -> float | None:
    """The points of several rows together; None where none of them is judged."""
    scores = [score for row in rows if (score := row.shown_score) is not None]
    return round(sum(scores), 4) if scores else None


@dataclass(frozen=True)
class Row:
    """One student's result in one exercise.

    Attributes:
        student: The student's id.
        assignment: The assignment's name.
        exercise: The exercise's id; the name of a cell that a person gives points for; ``late`` or ``dropped``.
        score: Points in the gradebook, those that a person gave included.
        max_score: Points that can be had.
        state: ``passed``, ``failed``, ``not_checked``, ``not_graded``, ``not_submitted``, ``excused``, ``waits``,
            ``by_hand``, ``late`` or ``dropped``.
        diagnosis: The key of the mistake, empty for none.
        reason: Its text, empty for none.
        judged: The judge's points in the gradebook; None where it has none.
        by_hand: Points that a person gave in their place; None where nobody did.
        extra: Points that a person gave on top.
        waits: Whether a person has to look at it.
        name: The student's name, empty where it is not known.
        remarks: Sentences on what was put right in the notebook, such as cells that were missing.
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
        """True if nothing is judged yet: such a row has no points, which is not zero points."""
        return self.state in _NOTHING_JUDGED and self.by_hand is None and not self.extra

    @property
    def is_unchecked(self) -> bool:
        """True if it was handed in and nothing is known of it: the next run may have its points."""
        return self.is_blank and self.state in (NOT_GRADED, State.NOT_CHECKED)

    @property
    def is_to_come(self) -> bool:
        """True if its points are still to come: from the next run, or from a person."""
        return self.is_unchecked or self.state == WAITS

    @property
    def shown_score(self) -> float | None:
        """The points; None where there are none to be had."""
        return None if self.is_blank else self.score

    @property
    def mark(self) -> str:
        """Behind the points: ``?`` where they wait for a person, ``*`` where a person gave some of them, or nothing."""
        return "?" if self.waits else "*" if self.by_hand is not None or self.extra else ""


def columns(rows: Iterable[Row]) -> dict[tuple[str, str], str]:
    """The name of the column for each exercise, by assignment and exercise.

    Cells of an instructor's own are often called alike in several assignments; then the assignment is in front.
    """
    keys = list(
        dict.fromkeys((row.assignment, row.exercise) for row in rows if row.exercise not in NO_EXERCISE)
    )
    often = Counter(exercise for _, exercise in keys)
    return {key: key[1] if often[key[1]] == 1 else ".".join(key) for key in keys}


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
                remarks=task.remarks,
            )
        )
    return found


def remarks_on(rows: Iterable[Row]) -> dict[tuple[str, str], str]:
    """The remarks on the notebooks of each student and assignment, in one line; only of those that have any."""
    found: dict[tuple[str, str], dict[str, None]] = {}
    for row in rows:
        found.setdefault((row.student, row.assignment), {}).update(dict.fromkeys(row.remarks))
    return {key: one_line(" ".join(remarks), _LONGEST_REMARKS) for key, remarks in found.items() if remarks}


def write_csv(path: Path, rows: Iterable[Row]) -> None:
    """Write the rows as UTF-8 CSV with the mark by which Excel knows it, replacing the file as a whole.

    Raises:
        OSError: It could not be written; an earlier file is still there then.
    """
    write_whole(path, csv_text([COLUMNS, *map(csv_cells, rows)]).encode("utf-8-sig"))


def csv_cells(row: Row) -> tuple[str | float, ...]:
    """A row as the cells of :data:`COLUMNS`."""
    return (
        row.student,
        row.assignment,
        row.exercise,
        "" if row.is_blank else row.score,
        row.max_score,
        row.state,
        row.diagnosis,
        row.reason,
        "" if row.judged is None else row.judged,
        "" if row.by_hand is None else row.by_hand,
        row.extra if row.extra else "",
        "yes" if row.waits else "",
        row.name,
    )
