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

    from autograder.grading.classes.class_dates import ClassDates
    from autograder.grading.classes.class_directory import Submission


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


def reset(url: str, submissions: Iterable[Submission]) -> None:
    """Set the automatic points of submissions to zero and mark their cells for review, in one transaction.

    Use this before a grading run, so that a failure cannot leave old points in the gradebook. Points that an instructor
    gave by hand are not changed.

    Args:
        url: The address by which SQLAlchemy opens the gradebook.
    """
    pairs = [{"assignment": one.assignment, "student": one.student} for one in submissions]
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
    submission: Submission,
    notebooks: Mapping[str, NotebookEntry],
    timestamp: datetime | None,
) -> bool:
    """Enter the results of one submission, in one transaction, without changing points and comments by a person.

    Args:
        url: The address by which SQLAlchemy opens the gradebook.
        submission: The submission. An unknown student is added.
        notebooks: The results by notebook.
        timestamp: The submission time in UTC; None to keep the time that is in the gradebook.

    Returns:
        True if the assignment has a due date, so that nbgrader has to compute the late penalty.

    Raises:
        LookupError: The gradebook does not contain the assignment or one of its notebooks.
    """
    assignment = submission.assignment
    names: dict[str, object] = {"assignment": assignment, "student": submission.student}
    with opened(url) as book:
        of_assignment = sql(
            "SELECT n.name, a.duedate FROM assignment a JOIN notebook n ON n.assignment_id = a.id"
            " WHERE a.name = :assignment"
        )
        due = {row.name: row.duedate for row in book.execute(of_assignment, names)}
        if missing := notebooks.keys() - due.keys():
            raise LookupError(
                f"the gradebook has no assignment named {assignment} with a notebook named {min(missing)}"
            )
        for statement in (
            "INSERT INTO student (id) VALUES (:student) ON CONFLICT (id) DO NOTHING",
            "INSERT INTO submitted_assignment (id, assignment_id, student_id)"
            " SELECT :id, a.id, :student FROM assignment a WHERE a.name = :assignment"
            " ON CONFLICT (assignment_id, student_id) DO NOTHING",
        ):
            _put(book, [{**names, "id": uuid.uuid4().hex}], statement)
        if timestamp is not None:
            setting = sql(
                "UPDATE submitted_assignment SET timestamp = :at WHERE student_id = :student"
                " AND assignment_id IN (SELECT id FROM assignment WHERE name = :assignment)"
            )
            typed = setting.bindparams(sqlalchemy.bindparam("at", type_=sqlalchemy.DateTime()))
            book.execute(typed, {**names, "at": timestamp})
        _put(
            book,
            [{**names, "id": uuid.uuid4().hex, "notebook": name, "no": False} for name in due],
            "INSERT INTO submitted_notebook (id, assignment_id, notebook_id, flagged) SELECT :id, s.id, n.id, :no"
            " FROM submitted_assignment s JOIN assignment a ON a.id = s.assignment_id"
            " JOIN notebook n ON n.assignment_id = a.id"
            " WHERE a.name = :assignment AND s.student_id = :student AND n.name = :notebook"
            " ON CONFLICT (notebook_id, assignment_id) DO UPDATE SET late_submission_penalty = NULL",
        )
        _enter_cells(book, names, notebooks)
    return any(due.values())


def _enter_cells(
    book: Connection, names: Mapping[str, object], notebooks: Mapping[str, NotebookEntry]
) -> None:
    """Enter the points and comments of all cells. A notebook without a result gets zero points."""
    cells = sql(
        "SELECT n.name AS notebook, sn.id AS submitted, b.id AS cell, b.name AS name, b.type AS type,"
        f" g.manual_score AS by_hand FROM {SUBMITTED} JOIN base_cell b ON b.notebook_id = n.id"
        " LEFT JOIN grade g ON g.notebook_id = sn.id AND g.cell_id = b.id"
        " WHERE a.name = :assignment AND s.student_id = :student"
    )
    graded: list[dict[str, object]] = []
    commented: list[dict[str, object]] = []
    for row in book.execute(cells, names).all():
        entry = notebooks.get(row.notebook, NotebookEntry({}, {}))
        place = {"id": uuid.uuid4().hex, "n": row.submitted, "cell": row.cell}
        if row.type in _GRADED:
            score = entry.scores.get(row.name, 0.0)
            # Mark a cell for review if a person gave points or still has to give them, as nbgrader's SaveAutoGrades
            # does.
            look = row.by_hand is not None or score is None or row.name in entry.unchecked
            graded.append({**place, "score": score, "look": look})
        if row.type in _COMMENTED:
            commented.append({**place, "comment": entry.comments.get(row.name)})
    _put(
        book,
        graded,
        "INSERT INTO grade (id, notebook_id, cell_id, auto_score, needs_manual_grade)"
        " VALUES (:id, :n, :cell, :score, :look) ON CONFLICT (cell_id, notebook_id)"
        " DO UPDATE SET auto_score = excluded.auto_score, needs_manual_grade = excluded.needs_manual_grade",
    )
    _put(
        book,
        commented,
        "INSERT INTO comment (id, notebook_id, cell_id, auto_comment) VALUES (:id, :n, :cell, :comment)"
        " ON CONFLICT (cell_id, notebook_id) DO UPDATE SET auto_comment = excluded.auto_comment",
    )


def enter_dates(url: str, dates: ClassDates, student: str = "") -> None:
    """Enter the due dates of assignments and the extensions of submissions, as ``class.toml`` has them.

    Args:
        url: The address by which SQLAlchemy opens the gradebook.
        dates: The dates; other assignments keep those of the gradebook.
        student: Enter only the extensions of this student; of all students if empty.
    """
    if not dates.due:
        return
    with opened(url) as book:
        if not has_tables(book):
            return
        of_assignment = sql("UPDATE assignment SET duedate = :due WHERE name = :name").bindparams(
            sqlalchemy.bindparam("due", type_=sqlalchemy.DateTime())
        )
        of_submission = sql("UPDATE submitted_assignment SET extension = :more WHERE id = :id").bindparams(
            sqlalchemy.bindparam("more", type_=sqlalchemy.Interval())
        )
        submissions = sql(
            "SELECT s.id, s.student_id FROM submitted_assignment s JOIN assignment a ON a.id = s.assignment_id"
            " WHERE a.name = :name AND (:student = '' OR s.student_id = :student)"
        )
        for name, due in dates.due.items():
            book.execute(of_assignment, {"due": due, "name": name})
            for id_, whose in book.execute(submissions, {"name": name, "student": student}).all():
                at = dates.of(whose, name, None)
                book.execute(of_submission, {"more": at - due if at and due else None, "id": id_})


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
