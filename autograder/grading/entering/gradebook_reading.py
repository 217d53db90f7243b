"""nbgrader's gradebook, read: its connections, each one transaction, and the points and comments of submissions.

In SQL on nbgrader's own tables (``nbgrader/api.py``, as of 0.9), because its objects cost a query for every cell, and
importing them more than a second.
"""

from __future__ import annotations

import functools
from collections.abc import Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING

import sqlalchemy
from sqlalchemy.pool import NullPool

if TYPE_CHECKING:
    from collections.abc import Iterator

    from sqlalchemy import Connection, Engine, TextClause

Scores = Mapping[str, float | None]
"""By grade_id; None where there is no automatic score."""

SUBMITTED = """
    submitted_assignment s
    JOIN assignment a ON a.id = s.assignment_id
    JOIN submitted_notebook sn ON sn.assignment_id = s.id
    JOIN notebook n ON n.id = sn.notebook_id
"""
"""The submitted notebooks, for FROM in a statement."""


@dataclass(frozen=True)
class CellState:
    """The gradebook's row of one cell of a student's notebook.

    Attributes:
        score: Points, those that a person gave included; None for a cell without points.
        max_score: Points that can be had; None like ``score``.
        comment: A person's comment, or else the automatic one.
    """

    score: float | None = None
    max_score: float | None = None
    comment: str | None = None


@dataclass(frozen=True)
class NotebookState:
    """The gradebook's rows of a student's notebook.

    Attributes:
        cells: By grade_id.
        late_penalty: Points that were taken off.
    """

    cells: Mapping[str, CellState]
    late_penalty: float = 0.0


@contextmanager
def opened(url: str) -> Iterator[Connection]:
    """A connection for one transaction, closed at the end of the block."""
    with _engine(url).begin() as connection:
        yield connection


@functools.lru_cache(maxsize=8)
def _engine(url: str) -> Engine:
    """Holds no connection, only what SQLAlchemy knows of the database and of our statements."""
    return sqlalchemy.create_engine(url, poolclass=NullPool)


@functools.lru_cache(maxsize=64)
def sql(statement: str) -> TextClause:
    """A statement, parsed once."""
    return sqlalchemy.text(statement)


def has_tables(book: Connection) -> bool:
    """True if nbgrader has made its tables in this database."""
    return sqlalchemy.inspect(book).has_table("grade")


def scores(url: str, assignment: str) -> dict[str, dict[str, Scores]]:
    """The automatic scores of an assignment: by student, by notebook, by grade_id."""
    return _scores(url, "a.name = :assignment", assignment=assignment)


def scores_of_student(url: str, assignment: str, student: str) -> dict[str, Scores]:
    """The automatic scores of one submission: by notebook, by grade_id."""
    found = _scores(
        url, "a.name = :assignment AND s.student_id = :student", assignment=assignment, student=student
    )
    return found.get(student, {})


def worth(url: str, assignment: str) -> dict[str, dict[str, float]]:
    """The points of each cell in the gradebook: by notebook, by grade_id."""
    found: dict[str, dict[str, float]] = {}
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
                cells = found.setdefault(notebook, {})
                if cell is not None:
                    cells[cell] = points
    return found


def states(url: str, assignment: str, student: str) -> dict[str, NotebookState]:
    """The points and comments that a feedback page shows of a submission, by notebook."""
    names = {"assignment": assignment, "student": student}
    of_student = "WHERE a.name = :assignment AND s.student_id = :student"
    cells: dict[str, dict[str, CellState]] = {}
    penalties: dict[str, float] = {}
    with opened(url) as book:
        for notebook, penalty in book.execute(
            sql(f"SELECT n.name, sn.late_submission_penalty FROM {SUBMITTED} {of_student}"), names
        ):
            penalties[notebook] = penalty or 0.0
        for notebook, cell, by_hand, automatic in book.execute(
            sql(
                f"SELECT n.name, b.name, c.manual_comment, c.auto_comment FROM {SUBMITTED}"
                f" JOIN comment c ON c.notebook_id = sn.id JOIN base_cell b ON b.id = c.cell_id {of_student}"
            ),
            names,
        ):
            comment = by_hand if by_hand is not None else automatic
            cells.setdefault(notebook, {})[cell] = CellState(comment=comment)
        for notebook, cell, by_hand, automatic, extra, of_grade, of_task in book.execute(
            sql(
                "SELECT n.name, b.name, g.manual_score, g.auto_score, g.extra_credit, gc.max_score, tc.max_score"
                f" FROM {SUBMITTED} JOIN grade g ON g.notebook_id = sn.id JOIN base_cell b ON b.id = g.cell_id"
                f" LEFT JOIN grade_cells gc ON gc.id = b.id LEFT JOIN task_cells tc ON tc.id = b.id {of_student}"
            ),
            names,
        ):
            base = by_hand if by_hand is not None else automatic
            known = cells.setdefault(notebook, {}).get(cell, CellState())
            cells[notebook][cell] = CellState(
                score=0.0 if base is None else base + (extra or 0.0),
                max_score=of_grade if of_grade is not None else of_task,
                comment=known.comment,
            )
    return {name: NotebookState(cells.get(name, {}), penalty) for name, penalty in penalties.items()}


def _scores(url: str, where: str, **names: str) -> dict[str, dict[str, Scores]]:
    found: dict[str, dict[str, dict[str, float | None]]] = {}
    with opened(url) as book:
        if not has_tables(book):
            return {}
        rows = book.execute(
            sql(
                f"SELECT s.student_id, n.name, b.name, g.auto_score FROM {SUBMITTED}"
                f" JOIN grade g ON g.notebook_id = sn.id JOIN base_cell b ON b.id = g.cell_id WHERE {where}"
            ),
            names,
        )
        for student, notebook, cell, score in rows:
            found.setdefault(student, {}).setdefault(notebook, {})[cell] = score
    return {student: dict(notebooks) for student, notebooks in found.items()}
