"""Writes the files for an LMS into the folder ``export`` of the class."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from autograder.grading.classes.class_directory import ClassDirectory
from autograder.grading.collecting.records import CollectedRecords
from autograder.grading.errors import GradingError, check_known, clear_place_errors, course_command
from autograder.grading.exporting import class_workbook, feedback_zips, lms_gradebooks
from autograder.grading.exporting.layouts import LAYOUTS, gradebook
from autograder.grading.table.class_table import ClassTable, read_table
from autograder.kit.in_words import counted
from autograder.regular_files import write_whole

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from pathlib import Path


@dataclass(frozen=True)
class Exported:
    """The files that an export wrote.

    Attributes:
        files: Pairs of a file and its purpose.
        notices: Sentences that the instructor should read before uploading.
    """

    files: tuple[tuple[Path, str], ...]
    notices: tuple[str, ...]


def export(
    path: Path,
    to: str,
    *,
    assignments: Sequence[str] = (),
    into: Path | None = None,
    folder: Path | None = None,
    absent_zero: bool = False,
    columns: Mapping[str, str] | None = None,
    sections: Sequence[str] = (),
) -> Exported:
    """Write points and feedback in the format of an LMS.

    Args:
        path: The class directory.
        to: A system in :data:`LAYOUTS`, or ``ilias``, ``csv`` or ``xlsx``.
        assignments: The assignments to export; by default all that at least one student has handed in.
        into: A list that the LMS has exported, to be filled in with points.
        folder: The folder to write into; by default ``export`` in the class.
        absent_zero: True to write zero for students who have handed in nothing; False to write nothing for them.
        columns: For assignments whose column in ``into`` has another name, that name.
        sections: The sections whose students are exported; all students if empty.

    Raises:
        GradingError: There is nothing to export, a grading run is in progress, or the list is missing or cannot be
            filled in.
    """
    if columns and not into:
        raise GradingError(
            "--column names a column of the list in --into: add --into LIST, or leave out --column."
        )
    directory = ClassDirectory(path)
    # The lock excludes a grading run: grades that the run has set to zero would look like results.
    with directory.lock():
        table = read_table(directory, sections)
        table = replace(table, absent=0.0) if absent_zero else table
        wanted = _assignments(table, assignments)
        folder = folder or directory.path / "export"
        notices: list[str] = []
        written = []
        if into:
            check_known(list(columns or ()), wanted, "assignment")
            wanted = list(columns or ()) or wanted
            filled, notices = lms_gradebooks.filled_in(into, to, table, wanted, columns or {})
            purpose = f"{to.capitalize()}: your exported list, now with the points of {', '.join(wanted)}"
        parts = [(into.name, filled, purpose)] if into else _files(directory, table, to, wanted, notices)
        for name, data, purpose in parts:
            with clear_place_errors(folder / name, "--output"):
                write_whole(folder / name, data)
            written.append((folder / name, purpose))
    notices += [
        f"{one.label} was not graded, so no points of it are exported: {one.sentence}"
        for one in table.unplaced
    ]
    notices += [
        f"{name} is left out of all students' points: {reason}" for name, reason in table.unusable.items()
    ]
    notices += table.notices
    if table.waiting:
        waiting = counted(len(table.waiting), "result")
        notices.append(f"{waiting} still to be graded by a person, exported with their present points")
    if table.stale:
        notices.append(
            f"{counted(len(table.stale), 'submission')} without points, or with points of earlier work or of another "
            "version of the course: "
            f"{', '.join(table.stale[:5])}{' …' if len(table.stale) > 5 else ''}. "
            f"Grade first: {course_command('grade', path)}"
        )
    return Exported(tuple(written), tuple(notices))


def _assignments(table: ClassTable, wanted: Sequence[str]) -> list[str]:
    table.check_usable(wanted)
    if not table.assignments:
        raise GradingError("Nothing was handed in yet, so there is nothing to export.")
    for name in wanted:
        if name not in table.assignments:
            raise GradingError(
                f"No student has handed in {name}. These were handed in: {', '.join(table.assignments)}."
            )
    return list(wanted) or table.assignments


def _files(
    directory: ClassDirectory, table: ClassTable, to: str, assignments: Sequence[str], notices: list[str]
) -> Iterator[tuple[str, bytes, str]]:
    records = CollectedRecords(directory.state)
    if to == "csv":
        yield "students.csv", class_workbook.as_csv(table, assignments), "a line for each student"
    elif to == "xlsx":
        yield (
            "grades.xlsx",
            class_workbook.as_xlsx(table, assignments),
            "one sheet that lists the students, and one that lists their results in the exercises",
        )
    elif to in LAYOUTS:
        text = gradebook(to, table, records, assignments)
        yield f"{to}.csv", text.encode(), LAYOUTS[to].purpose
    else:
        notices.append(f"{to.upper()} cannot import points from a file, so only feedback pages are written")
    for assignment in assignments if to in feedback_zips.WAYS else ():
        data, unknown = feedback_zips.feedback_zip(directory, table, records, assignment, to)
        if data:
            purpose = f"{to.capitalize()}: the assignment {assignment}, {feedback_zips.WAYS[to]}"
            yield f"feedback-{to}-{assignment}.zip", data, purpose
        if unknown:
            notices.append(
                f"the zip has no feedback on {assignment} for {', '.join(unknown)}: their work was not collected from "
                f"{to.capitalize()}, so the names that {to.capitalize()} gives to these pages are unknown"
            )
