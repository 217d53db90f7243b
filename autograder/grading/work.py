"""A submission on its way through a batch, and what may be said of it."""

from __future__ import annotations

import contextlib
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from autograder.grading.classes.timestamps import handed_in_at
from autograder.grading.reporting.rows import LATE, Row
from autograder.grading.table.entries import CellEntry, SubmissionEntry, read_due_dates
from autograder.grading.table.point_differences import Difference

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence
    from datetime import datetime

    from autograder.boxes.execution import Execution
    from autograder.grading.classes.class_directory import ClassDirectory, Submission
    from autograder.grading.rebuilding.source_points import GradedCell
    from autograder.grading.table.entries import Entries
    from autograder.grading.task import Task


@dataclass
class Work:
    """A submission on its way through the batch.

    Attributes:
        submission: Its place.
        fingerprint: Of what it is made from, as it was at the start.
        notebooks: The names of its notebooks.
        results: What is known of the notebooks that are not written down yet, by notebook.
        rows: What the judge says of it, or why it says nothing; None while nothing is known.
        written: Whether the gradebook holds exactly these results.
        shown: Stands for what the gradebook said when its pages were made; empty where there are none of these results.
    """

    submission: Submission
    fingerprint: str
    notebooks: Sequence[str]
    results: dict[str, tuple[Task, Execution]] = field(default_factory=dict)
    rows: tuple[Row, ...] | None = None
    written: bool = False
    shown: str = ""

    @property
    def key(self) -> tuple[str, str]:
        """Student and assignment, by which the gradebook knows it."""
        return self.submission.student, self.submission.assignment

    @property
    def complete(self) -> bool:
        """True if all of its notebooks have a result."""
        return len(self.results) == len(self.notebooks)

    @property
    def pairs(self) -> list[tuple[Task, Execution]]:
        """Tasks and results, in the order of the notebooks."""
        return [self.results[notebook] for notebook in self.notebooks]


def would_change(
    directory: ClassDirectory,
    works: Iterable[Work],
    entries: Entries,
    cells: Mapping[str, Sequence[GradedCell]],
) -> list[Difference]:
    """The students who would get other points from the judge, or lose others for being late.

    Args:
        directory: The class.
        works: The submissions.
        entries: What the gradebook has.
        cells: The cells with points, by assignment.
    """
    found = []
    due = read_due_dates(directory.gradebook_url)
    for work in works:
        entry = entries.get(work.key, SubmissionEntry())
        by_exercise = {cell.exercise: cell for cell in cells[work.submission.assignment]}
        for row in () if work.written else work.rows or ():
            cell = by_exercise[row.exercise]
            kept = entry.cells.get(cell.notebook, {}).get(cell.name)
            before = kept.judged if kept else None
            if before != row.score:
                note = "a person's points stay" if kept and kept.by_hand is not None else ""
                found.append(Difference(*work.key, row.exercise, before, row.score, "", row.diagnosis, note))
        then = _foreseen(work, entry, by_exercise, due.get(work.submission.assignment))
        if then.is_late or entry.penalty:
            from autograder.grading.table.late_policy import penalties  # here: nbgrader takes a second

            costs = penalties(directory.config, work.submission.student, then).values()
            then = replace(then, penalty=sum(cost or 0.0 for cost in costs))
            if then.taken_off != entry.taken_off:
                before, after = (-one.taken_off if one.taken_off else None for one in (entry, then))
                found.append(Difference(*work.key, LATE, before, after, note=then.why_late))
    return found


def _foreseen(
    work: Work, entry: SubmissionEntry, by_exercise: Mapping[str, GradedCell], due: datetime | None
) -> SubmissionEntry:
    """What the gradebook would have of a submission after a run, but for what being late costs."""
    cells = {notebook: dict(of_notebook) for notebook, of_notebook in entry.cells.items()}
    for row in () if work.written else work.rows or ():
        cell = by_exercise[row.exercise]
        of_notebook = cells.setdefault(cell.notebook, {})
        of_notebook[cell.name] = replace(of_notebook.get(cell.name, CellEntry(cell.worth)), judged=row.score)
    at = entry.handed_in
    with contextlib.suppress(ValueError):  # the run itself refuses such a time
        at = handed_in_at(work.submission.folder) or at
    return replace(entry, handed_in=at, due=entry.due or due, cells=cells)


def without_grade(row: Row) -> Row:
    """The row of a result that could not be entered."""
    reason = "The result could not be entered into the gradebook; it has zero points there."
    return Row(
        row.student,
        row.assignment,
        row.exercise,
        0.0,
        row.max_score,
        "not_checked",
        "not_written_down",
        reason,
    )
