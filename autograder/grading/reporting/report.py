"""The result of a grading run, as a Python object and as the JSON that ``grade --json`` prints."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from itertools import groupby
from typing import TYPE_CHECKING, Any

import msgspec

from autograder.grading.reporting.rows import DROPPED, LATE, NO_EXERCISE, Row, remarks_on, total
from autograder.grading.running.batch_times import Timings
from autograder.regular_files import name_as_text
from autograder.verdict import State

if TYPE_CHECKING:
    from collections.abc import Mapping
    from datetime import datetime
    from pathlib import Path

    from autograder.grading.classes.class_directory import RefusedFile
    from autograder.grading.table.class_table import ClassTable
    from autograder.grading.table.point_differences import Difference

FORM = 2
"""The version of the JSON format. It increases when a field is renamed or removed."""


@dataclass(frozen=True)
class GradeReport:
    """The result of a grading run.

    Attributes:
        path: The class directory.
        rows: The rows, sorted by student and then in the order of the course.
        refused: Files and folders in ``submitted`` that cannot be graded, each with the reason.
        problems: Sentences about other failures, for which no student has points.
        notices: Sentences for the instructor that are not about a failure.
        would_change: After a dry run, the points that would change; None if points were entered.
        executed: The number of notebooks that were executed.
        reused: The number of notebooks whose result was already known.
        written: The number of submissions that this run entered into the gradebook.
        seconds: The duration of the run, in seconds of wall time.
        timings: The seconds that each step took.
        note: A warning if submissions were run without a sandbox, so that the points may be forged; otherwise empty.
        gradebook: The path of the gradebook's SQLite file; None if the gradebook is on a database server.
        due: The due date of each assignment that has one, in the time zone of the class.
    """

    path: Path
    rows: tuple[Row, ...]
    refused: tuple[RefusedFile, ...] = ()
    problems: tuple[str, ...] = ()
    notices: tuple[str, ...] = ()
    would_change: tuple[Difference, ...] | None = None
    executed: int = 0
    reused: int = 0
    written: int = 0
    seconds: float = 0.0
    timings: Timings = field(default_factory=Timings)
    note: str = ""
    gradebook: Path | None = None
    due: Mapping[str, datetime] = field(default_factory=dict)

    @property
    def csv(self) -> Path:
        """The path of ``grades.csv``, which contains all rows."""
        return self.path / "grades.csv"

    @property
    def feedback(self) -> Path:
        """The folder with the feedback pages for students."""
        return self.path / "feedback"

    @property
    def exit_code(self) -> int:
        """The command's exit code: 0 if everything was graded; 2 if a check or a file could not be graded."""
        unchecked = any(row.state == State.NOT_CHECKED for row in self.rows)
        return 2 if self.refused or self.problems or unchecked else 0


def report_json(report: GradeReport) -> bytes:
    """Return the report as one line of JSON."""
    return msgspec.json.encode(
        {
            "form": FORM,
            "class": str(report.path),
            "exit_code": report.exit_code,
            "note": report.note,
            "submissions": _submissions(report.rows),
            "refused": [
                {"path": name_as_text(str(refused.path)), "reason": name_as_text(refused.reason)}
                for refused in report.refused
            ],
            "problems": [name_as_text(text) for text in report.problems],
            "due": report.due,
            "notices": [name_as_text(text) for text in report.notices],
            "would_change": report.would_change,
            "totals": {
                "executed": report.executed,
                "reused": report.reused,
                "written": report.written,
                "score": sum(row.score for row in report.rows),
                "max_score": sum(row.max_score for row in report.rows),
                "waiting_for_a_person": sum(row.waits for row in report.rows),
                "not_checked": sum(row.state == State.NOT_CHECKED for row in report.rows),
                "seconds": round(report.seconds, 3),
            },
            "timings": {name: round(value, 3) for name, value in asdict(report.timings).items()},
        }
    )


def table_json(page: Path, table: ClassTable) -> bytes:
    """Return a class's table of results and the path of the report page as one line of JSON."""
    return msgspec.json.encode(
        {
            "form": FORM,
            "page": str(page),
            "submissions": _submissions(table.rows),
            "waiting": [{"file": one.label, "reason": one.sentence} for one in table.unplaced],
            "not_graded": table.stale,
            "notices": table.notices,
        }
    )


def _submissions(rows: tuple[Row, ...]) -> list[dict[str, Any]]:
    """Return a JSON object for each submission, in the order of the rows."""
    found = []
    for (student, assignment), group in groupby(rows, key=lambda row: (row.student, row.assignment)):
        all_rows = list(group)
        exercises = [row for row in all_rows if row.exercise != DROPPED]
        found.append(
            {
                "student": student,
                "name": exercises[0].name,
                "assignment": assignment,
                "score": total(exercises),
                "max_score": sum(row.max_score for row in exercises),
                "is_dropped": exercises != all_rows,
                "remarks": remarks_on(all_rows).get((student, assignment), ""),
                "late_penalty": -sum(row.score for row in exercises if row.exercise == LATE),
                "exercises": [
                    {
                        "exercise": row.exercise,
                        "score": row.shown_score,
                        "max_score": row.max_score,
                        "state": row.state,
                        "diagnosis": row.diagnosis,
                        "reason": row.reason,
                        "judge": row.judged,
                        "by_hand": row.by_hand,
                        "extra": row.extra,
                        "waits_for_a_person": row.waits,
                    }
                    for row in exercises
                    if row.exercise not in NO_EXERCISE
                ],
            }
        )
    return found
