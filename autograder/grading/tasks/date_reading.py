"""Reads the due dates and extensions that ``class.toml`` sets."""

from __future__ import annotations

from datetime import UTC, date, datetime, time
from typing import TYPE_CHECKING

from autograder.grading.classes.class_dates import ClassDates
from autograder.grading.classes.class_file import NAME, read_class_file
from autograder.grading.collecting.written_times import read_time
from autograder.grading.grading_errors import GradingError, check_known

if TYPE_CHECKING:
    from autograder.grading.classes.class_directory import ClassDirectory
    from autograder.grading.table.roster import Roster

_NONE = "none"
_EXAMPLE = '"2026-01-31 23:59"'


def read_class_dates(directory: ClassDirectory, roster: Roster) -> ClassDates:
    """Return the dates in ``class.toml``. The extension of a section is each student's in it, and the latest counts.

    Raises:
        GradingError: An assignment, a student or a section does not exist, or a date is not one or is too early.
    """
    said, path = read_class_file(directory.path), directory.path / NAME
    names = directory.assignments()
    check_known((*said.due, *said.extension), names, f"assignment for {path}")
    due = {name: _date(directory, f"due.{name}", value) for name, value in said.due.items()}
    extended: dict[tuple[str, str], datetime] = {}
    for assignment, of_assignment in said.extension.items():
        before = due.get(assignment)
        if before is None:
            raise GradingError(
                f"{path} extends {assignment}, which has no date there: write {assignment} = {_EXAMPLE} under [due]."
            )
        for whom, value in of_assignment.items():
            at = _date(directory, f"extension.{assignment}.{whom}", value)
            if at is None or at <= before:
                raise GradingError(
                    f"{path}: extension.{assignment}.{whom} is not later than the due date. It is the new date."
                )
            students = [one.id for one in roster.students.values() if whom == one.id or whom in one.sections]
            if not students:
                raise GradingError(
                    f"{path}: extension.{assignment}.{whom} is for no student: students.csv has neither this id nor "
                    "this section."
                )
            for student in students:
                extended[student, assignment] = max(at, extended.get((student, assignment), at))
    return ClassDates(due, extended)


def _date(directory: ClassDirectory, name: str, value: object) -> datetime | None:
    """Return a date in UTC. A day means its last minute, and a time without a zone is in the zone of the class."""
    found = read_time(value) if isinstance(value, str) and value != _NONE else value
    if value == _NONE:
        return None
    if isinstance(found, date) and not isinstance(found, datetime):
        found = datetime.combine(found, time(23, 59))
    if isinstance(found, datetime) and isinstance(value, str) and len(value.strip()) == len("2026-01-31"):
        found = datetime.combine(found.date(), time(23, 59))
    if not isinstance(found, datetime):
        raise GradingError(
            f"{directory.path / NAME}: {name} is not a date: {value!r}. Write a text such as {_EXAMPLE}, or {_NONE!r}."
        )
    zoned = found if found.tzinfo else found.replace(tzinfo=directory.time_zone)
    return zoned.astimezone(UTC).replace(tzinfo=None)
