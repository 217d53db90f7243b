"""Writes to nbgrader's gradebook: sets points to zero, and enters points, comments, times and late penalties."""

from __future__ import annotations

import re  # noqa: TID251  (our own statements)
import uuid
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import sqlalchemy

from autograder.grading.classes.gradebook_reading import SUBMITTED, has_tables, opened, sql

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable
    from datetime import datetime

    from sqlalchemy import Connection


Scores = Mapping[str, float | None]
"""The points of cells by grade_id; None if a person has to give the points."""

_GRADED = ("GradeCell", "TaskCell")
_COMMENTED = ("SolutionCell", "TaskCell")

_PARAMETER = re.compile(r":(\w+)")


@dataclass(frozen=True)
class NotebookEntry:
    """The entry of one notebook in the gradebook.

    Attributes:
        scores: The automatic points of each graded cell, by grade_id; None if a person has to give them.
        comments: The automatic comments by grade_id, for each cell that may have a comment; None for no comment.
        unchecked: The grade_ids of cells that could not be checked. They get zero points and are marked for review.
    """

    scores: Scores
    comments: Mapping[str, str | None]
    unchecked: Collection[str] = ()


def reset(url: str, submissions: Iterable[tuple[str, str]]) -> None:
    """Set the automatic points of submissions to zero and mark their cells for review, in one transaction.

    Use this before a grading run, so that a failure cannot leave old points in the gradebook. Points that an instructor
    gave by hand are not changed.

    Args:
        url: The address by which SQLAlchemy opens the gradebook.
        submissions: Pairs of an assignment and a student.
    """
    pairs = [{"assignment": assignment, "student": student} for assignment, student in submissions]
    with opened(url) as book:
        if pairs and has_tables(book):
            book.execute(
                sql(
                    "UPDATE grade SET auto_score = 0, needs_manual_grade = :yes WHERE notebook_id IN"
                    f" (SELECT sn.id FROM {SUBMITTED} WHERE a.name = :assignment AND s.student_id = :student)"
                ),
                [{**pair, "yes": True} for pair in pairs],
            )


def enter(
    url: str,
    assignment: str,
    student: str,
    notebooks: Mapping[str, NotebookEntry],
    timestamp: datetime | None,
) -> bool:
    """Enter the results of one submission, in one transaction, without changing points and comments by a person.

    Args:
        url: The address by which SQLAlchemy opens the gradebook.
        student: The student's id. An unknown student is added.
        notebooks: The results by notebook.
        timestamp: The submission time in UTC; None to keep the time that is in the gradebook.

    Returns:
        True if the assignment has a due date, so that nbgrader has to compute the late penalty.

    Raises:
        LookupError: The gradebook does not contain the assignment or one of its notebooks.
    """
    with opened(url) as book:
        row = book.execute(
            sql("SELECT id, duedate FROM assignment WHERE name = :name"), {"name": assignment}
        ).first()
        if row is None:
            raise LookupError(f"the gradebook has no assignment named {assignment}")
        assignment_id, due = row
        submission = _submission(book, assignment_id, student, timestamp)
        cells = _cells(book, assignment_id)
        for name, entry in notebooks.items():
            if name not in cells:
                raise LookupError(f"the gradebook has no notebook named {name} in {assignment}")
            _enter_notebook(book, submission, cells[name], entry)
        # A notebook without a result also gets an entry, with zero points.
        for name in cells.keys() - notebooks.keys():
            _enter_notebook(book, submission, cells[name], NotebookEntry({}, {}))
    return due is not None


@dataclass(frozen=True)
class _Cells:
    """The id of a notebook in the gradebook, and its cells: pairs of an id in the gradebook and a grade_id."""

    notebook: str
    graded: tuple[tuple[str, str], ...]
    commented: tuple[tuple[str, str], ...]


def _cells(book: Connection, assignment: str) -> dict[str, _Cells]:
    rows = book.execute(
        sql(
            "SELECT n.id, n.name, b.id, b.name, b.type FROM notebook n"
            " LEFT JOIN base_cell b ON b.notebook_id = n.id WHERE n.assignment_id = :id"
        ),
        {"id": assignment},
    ).all()
    return {
        name: _Cells(
            notebook,
            tuple((row[2], row[3]) for row in rows if row[0] == notebook and row[4] in _GRADED),
            tuple((row[2], row[3]) for row in rows if row[0] == notebook and row[4] in _COMMENTED),
        )
        for notebook, name in {(row[0], row[1]) for row in rows}
    }


def _submission(book: Connection, assignment: str, student: str, timestamp: datetime | None) -> str:
    """Return the id of a submission in the gradebook, after adding a missing submission and setting its time."""
    if not book.execute(sql("SELECT 1 FROM student WHERE id = :id"), {"id": student}).first():
        book.execute(sql("INSERT INTO student (id) VALUES (:id)"), {"id": student})
    pair = {"a": assignment, "s": student}
    book.execute(
        sql(
            "INSERT INTO submitted_assignment (id, assignment_id, student_id) VALUES (:id, :a, :s)"
            " ON CONFLICT (assignment_id, student_id) DO NOTHING"
        ),
        {"id": uuid.uuid4().hex, **pair},
    )
    if timestamp is not None:
        book.execute(
            sql(
                "UPDATE submitted_assignment SET timestamp = :at WHERE assignment_id = :a AND student_id = :s"
            ).bindparams(sqlalchemy.bindparam("at", type_=sqlalchemy.DateTime())),
            {"at": timestamp, **pair},
        )
    found = sql("SELECT id FROM submitted_assignment WHERE assignment_id = :a AND student_id = :s")
    return str(book.execute(found, pair).scalar_one())


def enter_time(url: str, assignment: str, student: str, timestamp: datetime) -> None:
    """Enter the submission time of a submission.

    Args:
        url: The address by which SQLAlchemy opens the gradebook.
        timestamp: The time in UTC.
    """
    with opened(url) as book:
        assignment_id = book.execute(
            sql("SELECT id FROM assignment WHERE name = :name"), {"name": assignment}
        ).scalar()
        if assignment_id is not None:
            _submission(book, assignment_id, student, timestamp)


def enter_penalties(url: str, assignment: str, student: str, penalties: Mapping[str, float | None]) -> None:
    """Enter the late penalty of each notebook of a submission.

    Args:
        url: The address by which SQLAlchemy opens the gradebook.
        penalties: The points to subtract, by notebook; None for no penalty.
    """
    rows: list[dict[str, object]] = [
        {"a": assignment, "s": student, "n": notebook, "costs": costs}
        for notebook, costs in penalties.items()
    ]
    with opened(url) as book:
        _put(
            book,
            rows,
            "UPDATE submitted_notebook SET late_submission_penalty = :costs WHERE id IN"
            f" (SELECT sn.id FROM {SUBMITTED} WHERE a.name = :a AND s.student_id = :s AND n.name = :n)",
        )


def _enter_notebook(book: Connection, submission: str, cells: _Cells, entry: NotebookEntry) -> None:
    pair = {"s": submission, "n": cells.notebook}
    book.execute(
        sql(
            "INSERT INTO submitted_notebook (id, assignment_id, notebook_id, flagged) VALUES (:id, :s, :n, :no)"
            " ON CONFLICT (notebook_id, assignment_id) DO UPDATE SET late_submission_penalty = NULL"
        ),
        {"id": uuid.uuid4().hex, "no": False, **pair},
    )
    found = sql("SELECT id FROM submitted_notebook WHERE assignment_id = :s AND notebook_id = :n")
    notebook = str(book.execute(found, pair).scalar_one())
    scores = entry.scores
    by_hand = {
        row.cell_id
        for row in book.execute(
            sql("SELECT cell_id FROM grade WHERE notebook_id = :n AND manual_score IS NOT NULL"),
            {"n": notebook},
        )
    }
    graded: list[dict[str, object]] = [
        {
            "id": uuid.uuid4().hex,
            "n": notebook,
            "cell": cell,
            "score": scores.get(name, 0.0),
            # Mark a cell for review if a person gave points or still has to give them, as nbgrader's SaveAutoGrades
            # does.
            "look": cell in by_hand or scores.get(name, 0.0) is None or name in entry.unchecked,
        }
        for cell, name in cells.graded
    ]
    _put(
        book,
        graded,
        "INSERT INTO grade (id, notebook_id, cell_id, auto_score, needs_manual_grade)"
        " VALUES (:id, :n, :cell, :score, :look) ON CONFLICT (cell_id, notebook_id)"
        " DO UPDATE SET auto_score = excluded.auto_score, needs_manual_grade = excluded.needs_manual_grade",
    )
    commented: list[dict[str, object]] = [
        {"id": uuid.uuid4().hex, "n": notebook, "cell": cell, "comment": entry.comments.get(name)}
        for cell, name in cells.commented
    ]
    _put(
        book,
        commented,
        "INSERT INTO comment (id, notebook_id, cell_id, auto_comment) VALUES (:id, :n, :cell, :comment)"
        " ON CONFLICT (cell_id, notebook_id) DO UPDATE SET auto_comment = excluded.auto_comment",
    )


def rename(url: str, ids: Mapping[str, str]) -> None:
    """Give students other ids, in one transaction. If both ids have an entry for an assignment, the new one's stays.

    Args:
        url: The address by which SQLAlchemy opens the gradebook.
        ids: The new ids by the old ones. No new id may be one of the old ones.
    """
    with opened(url) as book:
        for old, new in ids.items() if has_tables(book) else ():
            for statement in _RENAME:
                book.execute(sql(statement), {"old": old, "new": new})


_DOUBLE = (
    "SELECT id FROM submitted_assignment WHERE student_id = :old AND assignment_id IN"
    " (SELECT assignment_id FROM submitted_assignment WHERE student_id = :new)"
)
_OF_DOUBLE = f"SELECT id FROM submitted_notebook WHERE assignment_id IN ({_DOUBLE})"
_RENAME = (
    "INSERT INTO student (id, first_name, last_name, email, lms_user_id)"
    " SELECT CAST(:new AS VARCHAR(128)), first_name, last_name, email, lms_user_id FROM student WHERE id = :old"
    " ON CONFLICT (id) DO NOTHING",
    f"DELETE FROM grade WHERE notebook_id IN ({_OF_DOUBLE})",
    f"DELETE FROM comment WHERE notebook_id IN ({_OF_DOUBLE})",
    f"DELETE FROM submitted_notebook WHERE assignment_id IN ({_DOUBLE})",
    f"DELETE FROM submitted_assignment WHERE id IN ({_DOUBLE})",
    "UPDATE submitted_assignment SET student_id = :new WHERE student_id = :old",
    "DELETE FROM student WHERE id = :old",
)


def _put(book: Connection, rows: list[dict[str, object]], statement: str) -> None:
    """Execute a statement for each row, with the fields that the statement names as ``:field``."""
    if rows:
        names = _PARAMETER.findall(statement)
        book.execute(sql(statement), [{name: row[name] for name in names} for row in rows])
