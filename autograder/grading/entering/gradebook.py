"""nbgrader's gradebook, where points are: taking them back, entering them and looking them up.

In SQL on nbgrader's own tables (``nbgrader/api.py``, as of 0.9), because its objects cost a query for every cell, and
importing them more than a second.
"""

from __future__ import annotations

import re  # noqa: TID251  (our own statements)
import uuid
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import sqlalchemy

from autograder.grading.entering.database import has_tables, opened, sql

if TYPE_CHECKING:
    from datetime import datetime

    from sqlalchemy import Connection

Scores = Mapping[str, float | None]
"""By grade_id; None where there is no automatic score."""

_GRADED = ("GradeCell", "TaskCell")
_COMMENTED = ("SolutionCell", "TaskCell")

_PARAMETER = re.compile(r":(\w+)")

_SUBMITTED = """
    submitted_assignment s
    JOIN assignment a ON a.id = s.assignment_id
    JOIN submitted_notebook sn ON sn.assignment_id = s.id
    JOIN notebook n ON n.id = sn.notebook_id
"""


class NoSuchAssignment(LookupError):
    """The gradebook has no assignment or notebook of that name."""


@dataclass(frozen=True)
class NotebookEntry:
    """The entry of one notebook.

    Attributes:
        scores: Automatic points of each graded cell, by grade_id; None where a person has to give them.
        comments: Automatic comment on each cell that can have one, by grade_id.
    """

    scores: Scores
    comments: Mapping[str, str | None]


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


def reset(url: str, submissions: Iterable[tuple[str, str]]) -> None:
    """Take back the automatic grades of these submissions, in one transaction.

    Zero, and marked as to be looked at: whatever happens from here on, no earlier score is left. A grade that
    an instructor gave by hand is the instructor's and stays.

    Args:
        url: What SQLAlchemy opens the gradebook by.
        submissions: Pairs of assignment and student.
    """
    pairs = [{"assignment": assignment, "student": student} for assignment, student in submissions]
    with opened(url) as book:
        if pairs and has_tables(book):
            book.execute(
                sql(
                    "UPDATE grade SET auto_score = 0, needs_manual_grade = :yes WHERE notebook_id IN"
                    f" (SELECT sn.id FROM {_SUBMITTED} WHERE a.name = :assignment AND s.student_id = :student)"
                ),
                [{**pair, "yes": True} for pair in pairs],
            )


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


def enter(
    url: str,
    assignment: str,
    student: str,
    notebooks: Mapping[str, NotebookEntry],
    timestamp: datetime | None,
) -> bool:
    """Enter the results of one submission, in one transaction; what a person entered stays.

    Args:
        url: What SQLAlchemy opens the gradebook by.
        assignment: The assignment's name.
        student: The student's id; the student is made where there is none.
        notebooks: Results, by notebook.
        timestamp: When it was handed in, in UTC; what is known already stays where it is None.

    Returns:
        Whether the assignment has a due date, so that nbgrader has to say what being late costs.

    Raises:
        NoSuchAssignment: It was never generated.
    """
    with opened(url) as book:
        found = book.execute(
            sql("SELECT id, duedate FROM assignment WHERE name = :name"), {"name": assignment}
        ).first()
        if found is None:
            raise NoSuchAssignment(f"the gradebook has no assignment named {assignment}")
        assignment_id, due = found
        submission = _submission(book, assignment_id, student, timestamp)
        cells = _cells(book, assignment_id)
        for name, entry in notebooks.items():
            if name not in cells:
                raise NoSuchAssignment(f"the gradebook has no notebook named {name} in {assignment}")
            _enter_notebook(book, submission, cells[name], entry)
        # A notebook that no result is for has zero points, and is there all the same.
        for name in cells.keys() - notebooks.keys():
            _enter_notebook(book, submission, cells[name], NotebookEntry({}, {}))
    return due is not None


def states(url: str, assignment: str, student: str) -> dict[str, NotebookState]:
    """All that a feedback page says of a submission, by notebook."""
    names = {"assignment": assignment, "student": student}
    of_student = "WHERE a.name = :assignment AND s.student_id = :student"
    cells: dict[str, dict[str, CellState]] = {}
    penalties: dict[str, float] = {}
    with opened(url) as book:
        for notebook, penalty in book.execute(
            sql(f"SELECT n.name, sn.late_submission_penalty FROM {_SUBMITTED} {of_student}"), names
        ):
            penalties[notebook] = penalty or 0.0
        for notebook, cell, by_hand, automatic in book.execute(
            sql(
                f"SELECT n.name, b.name, c.manual_comment, c.auto_comment FROM {_SUBMITTED}"
                f" JOIN comment c ON c.notebook_id = sn.id JOIN base_cell b ON b.id = c.cell_id {of_student}"
            ),
            names,
        ):
            comment = by_hand if by_hand is not None else automatic
            cells.setdefault(notebook, {})[cell] = CellState(comment=comment)
        for notebook, cell, by_hand, automatic, extra, of_grade, of_task in book.execute(
            sql(
                "SELECT n.name, b.name, g.manual_score, g.auto_score, g.extra_credit, gc.max_score, tc.max_score"
                f" FROM {_SUBMITTED} JOIN grade g ON g.notebook_id = sn.id JOIN base_cell b ON b.id = g.cell_id"
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


@dataclass(frozen=True)
class _Cells:
    """A notebook's cells in the gradebook: its own id, then pairs of id and name."""

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
    """The id of a submission, made where there is none, with its timestamp as nbgrader keeps it."""
    if not book.execute(sql("SELECT 1 FROM student WHERE id = :id"), {"id": student}).first():
        book.execute(sql("INSERT INTO student (id) VALUES (:id)"), {"id": student})
    found = book.execute(
        sql("SELECT id FROM submitted_assignment WHERE assignment_id = :a AND student_id = :s"),
        {"a": assignment, "s": student},
    ).scalar()
    made = found or uuid.uuid4().hex
    if found is None:
        book.execute(
            sql("INSERT INTO submitted_assignment (id, assignment_id, student_id) VALUES (:id, :a, :s)"),
            {"id": made, "a": assignment, "s": student},
        )
    if timestamp is not None:
        book.execute(
            sql("UPDATE submitted_assignment SET timestamp = :at WHERE id = :id").bindparams(
                sqlalchemy.bindparam("at", type_=sqlalchemy.DateTime())
            ),
            {"at": timestamp, "id": made},
        )
    return str(made)


def enter_time(url: str, assignment: str, student: str, timestamp: datetime) -> None:
    """Enter when a submission that is known was handed in.

    Args:
        url: What SQLAlchemy opens the gradebook by.
        assignment: The assignment's name.
        student: The student's id.
        timestamp: In UTC.
    """
    with opened(url) as book:
        found = book.execute(
            sql("SELECT id FROM assignment WHERE name = :name"), {"name": assignment}
        ).scalar()
        if found is not None:
            _submission(book, found, student, timestamp)


def enter_penalties(url: str, assignment: str, student: str, penalties: Mapping[str, float | None]) -> None:
    """Enter what being late costs in each notebook of a submission.

    Args:
        url: What SQLAlchemy opens the gradebook by.
        assignment: The assignment's name.
        student: The student's id.
        penalties: Points to be taken off, by notebook; None for nothing.
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
            f" (SELECT sn.id FROM {_SUBMITTED} WHERE a.name = :a AND s.student_id = :s AND n.name = :n)",
        )


def _enter_notebook(book: Connection, submission: str, cells: _Cells, entry: NotebookEntry) -> None:
    notebook = book.execute(
        sql("SELECT id FROM submitted_notebook WHERE assignment_id = :s AND notebook_id = :n"),
        {"s": submission, "n": cells.notebook},
    ).scalar()
    if notebook is None:
        notebook = uuid.uuid4().hex
        book.execute(
            sql(
                "INSERT INTO submitted_notebook (id, assignment_id, notebook_id, flagged)"
                " VALUES (:id, :s, :n, :no)"
            ),
            {"id": notebook, "s": submission, "n": cells.notebook, "no": False},
        )
    book.execute(
        sql("UPDATE submitted_notebook SET late_submission_penalty = NULL WHERE id = :id"), {"id": notebook}
    )
    _enter_scores(book, notebook, cells, entry.scores)
    _enter_comments(book, notebook, cells, entry.comments)


def _enter_scores(book: Connection, notebook: str, cells: _Cells, scores: Scores) -> None:
    rows = book.execute(
        sql("SELECT cell_id, manual_score FROM grade WHERE notebook_id = :n"), {"n": notebook}
    ).all()
    by_hand: dict[str, float | None] = {row.cell_id: row.manual_score for row in rows}
    wanted: list[dict[str, object]] = [
        {
            "id": uuid.uuid4().hex,
            "n": notebook,
            "cell": cell,
            "score": scores.get(name, 0.0),
            # As nbgrader's SaveAutoGrades has it: a person looks where a person was, or has to be.
            "look": by_hand.get(cell) is not None or scores.get(name, 0.0) is None,
        }
        for cell, name in cells.graded
    ]
    _put(
        book,
        [row for row in wanted if row["cell"] not in by_hand],
        "INSERT INTO grade (id, notebook_id, cell_id, auto_score, needs_manual_grade)"
        " VALUES (:id, :n, :cell, :score, :look)",
    )
    _put(
        book,
        [row for row in wanted if row["cell"] in by_hand],
        "UPDATE grade SET auto_score = :score, needs_manual_grade = :look"
        " WHERE notebook_id = :n AND cell_id = :cell",
    )


def _enter_comments(
    book: Connection, notebook: str, cells: _Cells, comments: Mapping[str, str | None]
) -> None:
    known = set(
        book.execute(sql("SELECT cell_id FROM comment WHERE notebook_id = :n"), {"n": notebook}).scalars()
    )
    wanted: list[dict[str, object]] = [
        {"id": uuid.uuid4().hex, "n": notebook, "cell": cell, "comment": comments.get(name)}
        for cell, name in cells.commented
    ]
    _put(
        book,
        [row for row in wanted if row["cell"] not in known],
        "INSERT INTO comment (id, notebook_id, cell_id, auto_comment) VALUES (:id, :n, :cell, :comment)",
    )
    _put(
        book,
        [row for row in wanted if row["cell"] in known],
        "UPDATE comment SET auto_comment = :comment WHERE notebook_id = :n AND cell_id = :cell",
    )


def _put(book: Connection, rows: list[dict[str, object]], statement: str) -> None:
    """Execute a statement for each of the rows; it may name fewer fields than they have."""
    if rows:
        names = _PARAMETER.findall(statement)
        book.execute(sql(statement), [{name: row[name] for name in names} for row in rows])


def _scores(url: str, where: str, **names: str) -> dict[str, dict[str, Scores]]:
    found: dict[str, dict[str, dict[str, float | None]]] = {}
    with opened(url) as book:
        if not has_tables(book):
            return {}
        rows = book.execute(
            sql(
                f"SELECT s.student_id, n.name, b.name, g.auto_score FROM {_SUBMITTED}"
                f" JOIN grade g ON g.notebook_id = sn.id JOIN base_cell b ON b.id = g.cell_id WHERE {where}"
            ),
            names,
        )
        for student, notebook, cell, score in rows:
            found.setdefault(student, {}).setdefault(notebook, {})[cell] = score
    return {student: dict(notebooks) for student, notebooks in found.items()}
