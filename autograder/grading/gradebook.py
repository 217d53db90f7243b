"""nbgrader's gradebook, where points are: taking them back before a run and looking them up after it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from nbgrader.api import Gradebook, MissingEntry, SubmittedAssignment

Scores = Mapping[str, float | None]
"""By grade_id; None where there is no automatic score."""


def reset(url: str, submissions: Iterable[tuple[str, str]]) -> None:
    """Take back the automatic grades of these submissions, in one transaction.

    Zero, and marked as to be looked at: whatever happens from here on, no earlier score is left. A grade that
    an instructor gave by hand is the instructor's and stays.

    Args:
        url: What SQLAlchemy opens the gradebook by.
        submissions: Pairs of assignment and student.
    """
    with Gradebook(url) as book:
        for assignment, student in submissions:
            try:
                submission = book.find_submission(assignment, student)
            except MissingEntry:
                continue
            for notebook in submission.notebooks:
                for grade in notebook.grades:
                    grade.auto_score = 0.0
                    grade.needs_manual_grade = True
        book.db.commit()


def scores(url: str, assignment: str) -> dict[str, dict[str, Scores]]:
    """The automatic scores of an assignment: by student, by notebook, by grade_id."""
    with Gradebook(url) as book:
        try:
            submissions = book.find_assignment(assignment).submissions
        except MissingEntry:
            return {}
        return {submission.student.id: _scores(submission) for submission in submissions}


def scores_of_student(url: str, assignment: str, student: str) -> dict[str, Scores]:
    """The automatic scores of one submission: by notebook, by grade_id."""
    with Gradebook(url) as book:
        try:
            return _scores(book.find_submission(assignment, student))
        except MissingEntry:
            return {}


def _scores(submission: SubmittedAssignment) -> dict[str, Scores]:
    return {
        notebook.name: {grade.name: grade.auto_score for grade in notebook.grades}
        for notebook in submission.notebooks
    }


def worth(url: str, assignment: str) -> dict[str, dict[str, float]]:
    """What the gradebook has each automatically graded cell at: by notebook, by grade_id."""
    with Gradebook(url) as book:
        try:
            notebooks = book.find_assignment(assignment).notebooks
        except MissingEntry:
            return {}
        return {
            notebook.name: {cell.name: cell.max_score for cell in notebook.grade_cells}
            for notebook in notebooks
        }
