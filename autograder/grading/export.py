"""A plug-in for ``nbgrader export``: writes CSV in which a spreadsheet executes no formula."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from nbgrader.api import MissingEntry
from nbgrader.plugins import ExportPlugin

from autograder.grading.table.spreadsheet_csv import csv_text
from autograder.safe_files import write_whole

if TYPE_CHECKING:
    from collections.abc import Iterator

    from nbgrader.api import Gradebook

_ABOUT = ("assignment", "duedate", "timestamp", "student_id", "last_name", "first_name", "email")
_NUMBERS = ("raw_score", "late_submission_penalty", "score", "max_score")


class SafeCsvExport(ExportPlugin):
    """Writes one line for each student and assignment, with the columns of nbgrader's ``CsvExportPlugin``.

    nbgrader's own plug-in does not quote commas and line breaks in names. It also writes a name such as ``=1+1``
    unchanged, and a spreadsheet would execute this name as a formula.
    """

    def export(self, gradebook: Gradebook) -> None:
        """Write the file given by ``--to``, by default ``grades.csv``.

        Args:
            gradebook: nbgrader's open gradebook.
        """
        to = Path(self.to or "grades.csv")
        self.log.info("Exporting grades to %s", to)
        write_whole(to, csv_text([(*_ABOUT, *_NUMBERS), *self._rows(gradebook)]).encode("utf-8-sig"))

    def _rows(self, gradebook: Gradebook) -> Iterator[tuple[str | float, ...]]:
        for assignment in gradebook.assignments:
            if self.assignment and assignment.name not in map(str, self.assignment):
                continue
            for student in gradebook.students:
                if not self.student or student.id in map(str, self.student):
                    yield _row(gradebook, assignment, student)


def _row(gradebook: Gradebook, assignment: Any, student: Any) -> tuple[str | float, ...]:
    points: tuple[str | float, ...]
    try:
        submission: Any = gradebook.find_submission(assignment.name, student.id)
    except MissingEntry:
        timestamp, points = "", ("", "", "")
    else:
        timestamp, raw = submission.timestamp, float(submission.score)
        penalty = float(submission.late_submission_penalty or 0.0)
        points = (raw, penalty, max(0.0, raw - penalty))
    who = (student.id, student.last_name, student.first_name, student.email)
    about = (assignment.name, assignment.duedate, timestamp, *who)
    texts = ("" if text is None else str(text) for text in about)
    return (*texts, *points, float(assignment.max_score))
