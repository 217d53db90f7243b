"""The report of a batch as one JSON object: what ``grade --json`` prints."""

from __future__ import annotations

from dataclasses import asdict
from itertools import groupby
from typing import TYPE_CHECKING, Any

import msgspec

from autograder.grading.reporting.report import DROPPED, LATE, NO_EXERCISE, total
from autograder.verdict import State

if TYPE_CHECKING:
    from autograder.grading.reporting.report import GradeReport, Row

FORM = 2
"""Goes up when a field is renamed or taken away."""


def report_json(report: GradeReport) -> bytes:
    """One line of JSON: the batch, each submission, totals and where the time went."""
    return msgspec.json.encode(
        {
            "form": FORM,
            "class": str(report.path),
            "exit_code": report.exit_code,
            "note": report.note,
            "submissions": _submissions(report.rows),
            "refused": [{"path": str(refused.path), "reason": refused.reason} for refused in report.refused],
            "problems": list(report.problems),
            "notices": list(report.notices),
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


def _submissions(rows: tuple[Row, ...]) -> list[dict[str, Any]]:
    """One object for each student and assignment, in the order of the rows."""
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
