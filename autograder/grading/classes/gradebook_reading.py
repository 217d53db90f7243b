"""Reads submissions with their points and comments from nbgrader's gradebook.

This module uses SQL on nbgrader's tables (``nbgrader/api.py`` in version 0.9), because nbgrader's own objects would be
slow: they need a query for every cell, and importing them takes more than a second.
"""

from __future__ import annotations

import functools
import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING

import msgspec
import sqlalchemy
from sqlalchemy.pool import NullPool

from autograder.grading.classes.class_directory import in_zone

if TYPE_CHECKING:
    from contextlib import AbstractContextManager
    from datetime import tzinfo

    from sqlalchemy import Connection, Engine, TextClause


SUBMITTED = """
    submitted_assignment s
    JOIN assignment a ON a.id = s.assignment_id
    JOIN submitted_notebook sn ON sn.assignment_id = s.id
    JOIN notebook n ON n.id = sn.notebook_id
"""
"""SQL for use after FROM: joins the tables of submissions, assignments, and submitted notebooks."""
_FROM = "submitted_assignment s JOIN assignment a ON a.id = s.assignment_id"
_CELLS = f"""
    SELECT s.student_id AS student, a.name AS assignment, n.name AS notebook, b.name AS cell,
        g.auto_score AS judged, g.manual_score AS by_hand, g.extra_credit AS extra,
        g.needs_manual_grade AS waits, COALESCE(gc.max_score, tc.max_score, 0) AS most
    FROM {SUBMITTED}
        JOIN grade g ON g.notebook_id = sn.id JOIN base_cell b ON b.id = g.cell_id
        LEFT JOIN grade_cells gc ON gc.id = b.id LEFT JOIN task_cells tc ON tc.id = b.id
"""
# In nbgrader, a question that a person grades has two cells with the same name: one for the points, one for the
# comment.
_COMMENTS = f"""
    SELECT s.student_id AS student, a.name AS assignment, n.name AS notebook, b.name AS cell,
        COALESCE(c.manual_comment, c.auto_comment) AS said
    FROM {SUBMITTED}
        JOIN comment c ON c.notebook_id = sn.id JOIN base_cell b ON b.id = c.cell_id
    WHERE COALESCE(c.manual_comment, c.auto_comment) IS NOT NULL
"""
_SUBMISSIONS = f"""
    SELECT s.student_id AS student, a.name AS assignment, s.timestamp AS timestamp, a.duedate AS duedate,
        s.extension AS extension, st.first_name, st.last_name
    FROM {_FROM} JOIN student st ON st.id = s.student_id
"""
_PENALTIES = f"""
    SELECT s.student_id AS student, a.name AS assignment, n.name AS notebook, sn.late_submission_penalty AS penalty
    FROM {SUBMITTED} WHERE sn.late_submission_penalty != 0
"""


@dataclass(frozen=True)
class CellEntry:
    """The gradebook's entry for one cell of a submission.

    Attributes:
        max_score: The maximum points for the cell.
        judged: The automatic points; None if there are none.
        by_hand: The points by a person, which replace the automatic points; None if there are none.
        extra: Extra credit: points that a person added.
        waits: True if the cell is marked for review, that is, a person has to grade it.
        comment: The comment of a person; if there is none, the automatic comment.
    """

    max_score: float
    judged: float | None = None
    by_hand: float | None = None
    extra: float = 0.0
    waits: bool = False
    comment: str = ""

    @property
    def score(self) -> float:
        """The points that count for the cell."""
        return (self.by_hand if self.by_hand is not None else self.judged or 0.0) + self.extra


@dataclass(frozen=True)
class SubmissionEntry:
    """The gradebook's entry for one submission.

    Attributes:
        handed_in: The submission time in UTC; None if unknown.
        due: The due date in UTC, with the student's extension; None if the assignment has no due date.
        penalties: The late penalty in points, by notebook.
        cells: The entries of the cells, by notebook and then by grade_id.
        name: The student's name; empty if the gradebook has none.
    """

    handed_in: datetime | None = None
    due: datetime | None = None
    penalties: Mapping[str, float] = field(default_factory=dict)
    cells: Mapping[str, Mapping[str, CellEntry]] = field(default_factory=dict)
    name: str = ""

    @property
    def is_late(self) -> bool:
        """True if the submission was handed in after its due date."""
        return self.handed_in is not None and self.due is not None and self.handed_in > self.due

    @property
    def penalty(self) -> float:
        """The sum of the late penalties of all notebooks, in points."""
        return sum(self.penalties.values())

    @property
    def taken_off(self) -> float:
        """The points that the late penalty subtracts: at most all points, because no score becomes negative."""
        return min(self.penalty, max(0.0, self._earned))

    @property
    def points(self) -> float:
        """The points that are left after the late penalty. The weights of the class are not applied."""
        return self._earned - self.taken_off

    @property
    def has_points_by_hand(self) -> bool:
        """True if a person gave points."""
        cells = [cell for cells in self.cells.values() for cell in cells.values()]
        return any(cell.by_hand is not None or cell.extra for cell in cells)

    @property
    def _earned(self) -> float:
        return sum(cell.score for cells in self.cells.values() for cell in cells.values())

    def why_late(self, zone: tzinfo) -> str:
        """Return the submission time and the due date as text, in a time zone; empty without a late penalty."""
        if not self.taken_off:
            return ""
        # The due date may have been removed after the penalty was entered.
        times = (("handed in", self.handed_in), ("due", self.due))
        return ", ".join(f"{word} {in_zone(at.replace(tzinfo=UTC), zone)}" for word, at in times if at)

    def judged(self, notebook: str, cell: str) -> float | None:
        """Return the automatic points of a cell; None if there are none."""
        entry = self.cells.get(notebook, {}).get(cell)
        return entry.judged if entry else None

    def shown(self) -> str:
        """Return a hash of the whole entry. If the hash changes, the feedback page has to be made again."""
        return hashlib.sha256(msgspec.json.encode(self, order="deterministic")).hexdigest()


Entries = Mapping[tuple[str, str], SubmissionEntry]
"""The gradebook's entries, by student and assignment."""


def opened(url: str) -> AbstractContextManager[Connection]:
    """Open a connection for one transaction. At the end of the block, the transaction is committed."""
    return _engine(url).begin()


@functools.lru_cache(maxsize=8)
def _engine(url: str) -> Engine:
    """Return SQLAlchemy's engine for a gradebook. It opens a new connection for each ``with`` statement."""
    return sqlalchemy.create_engine(url, poolclass=NullPool)


@functools.lru_cache(maxsize=64)
def sql(statement: str) -> TextClause:
    """Return a statement in the form that SQLAlchemy executes, parsed only once for each text."""
    return sqlalchemy.text(statement)


def gradebook_file(url: str) -> Path | None:
    """Return the path of a gradebook's SQLite file; None if the gradebook is on a database server."""
    address = sqlalchemy.make_url(url)
    return Path(address.database) if address.database and address.get_backend_name() == "sqlite" else None


def has_tables(book: Connection) -> bool:
    """Return True if nbgrader has created its tables in this database."""
    return sqlalchemy.inspect(book).has_table("grade")


def max_scores(url: str, assignment: str) -> dict[str, dict[str, float]]:
    """Return the maximum points of each cell in the gradebook, by notebook and then by grade_id."""
    scores: dict[str, dict[str, float]] = {}
    with opened(url) as book:
        if has_tables(book):
            rows = book.execute(
                sql(
                    "SELECT n.name, b.name, COALESCE(g.max_score, t.max_score) FROM assignment a"
                    " JOIN notebook n ON n.assignment_id = a.id"
                    " LEFT JOIN base_cell b ON b.notebook_id = n.id AND b.type IN ('GradeCell', 'TaskCell')"
                    " LEFT JOIN grade_cells g ON g.id = b.id LEFT JOIN task_cells t ON t.id = b.id"
                    " WHERE a.name = :assignment"
                ),
                {"assignment": assignment},
            )
            for notebook, cell, points in rows:
                cells = scores.setdefault(notebook, {})
                if cell is not None:
                    cells[cell] = points
    return scores


def read_entries(url: str, *, student: str = "", assignment: str = "") -> Entries:
    """Return the submissions in the gradebook, by student and assignment.

    Args:
        url: The address by which SQLAlchemy opens the gradebook.
        student: Return only submissions of this student; of all students if empty.
        assignment: Return only submissions for this assignment; for all assignments if empty.
    """
    names = {"student": student, "assignment": assignment}
    narrow = "(:student = '' OR s.student_id = :student) AND (:assignment = '' OR a.name = :assignment)"
    cells: dict[tuple[str, str], dict[str, dict[str, CellEntry]]] = {}
    penalties: dict[tuple[str, str], dict[str, float]] = {}
    entries: dict[tuple[str, str], SubmissionEntry] = {}
    with opened(url) as book:
        if not has_tables(book):
            return {}
        # Four statements for the whole class, and not some for each submission, of which there may be thousands.
        for row in book.execute(sql(f"{_CELLS} WHERE {narrow}"), names):
            of_notebook = cells.setdefault((row.student, row.assignment), {}).setdefault(row.notebook, {})
            of_notebook[row.cell] = CellEntry(
                row.most, row.judged, row.by_hand, row.extra or 0.0, bool(row.waits)
            )
        for row in book.execute(sql(f"{_COMMENTS} AND {narrow}"), names):
            of_notebook = cells.setdefault((row.student, row.assignment), {}).setdefault(row.notebook, {})
            entry = of_notebook.get(row.cell, CellEntry(0.0))
            of_notebook[row.cell] = replace(entry, comment=row.said)
        for row in book.execute(sql(f"{_PENALTIES} AND {narrow}"), names):
            penalties.setdefault((row.student, row.assignment), {})[row.notebook] = row.penalty
        for row in book.execute(
            sqlalchemy.text(f"{_SUBMISSIONS} WHERE {narrow}").columns(
                timestamp=sqlalchemy.DateTime(),
                duedate=sqlalchemy.DateTime(),
                extension=sqlalchemy.Interval(),
            ),
            names,
        ):
            due = row.duedate
            if due is not None and row.extension is not None:
                due = due + row.extension
            key = (row.student, row.assignment)
            name = " ".join(part for part in (row.first_name, row.last_name) if part)
            entries[key] = SubmissionEntry(
                row.timestamp, due, penalties.get(key, {}), cells.get(key, {}), name
            )
    return entries


def read_entry(url: str, student: str, assignment: str) -> SubmissionEntry:
    """Return the gradebook's entry for one submission; an empty entry if there is none."""
    entries = read_entries(url, student=student, assignment=assignment)
    return entries.get((student, assignment), SubmissionEntry())


def read_due_dates(url: str) -> dict[str, datetime]:
    """Return the due dates of assignments by name, in UTC. Extensions for single students are not included."""
    with opened(url) as book:
        if not has_tables(book):
            return {}
        dates = sqlalchemy.text("SELECT name, duedate FROM assignment WHERE duedate IS NOT NULL")
        return {row.name: row.duedate for row in book.execute(dates.columns(duedate=sqlalchemy.DateTime()))}
