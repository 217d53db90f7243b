"""Writes the files for an LMS or a spreadsheet into the folder ``export`` of the class: points, and feedback pages.

Each LMS finds the student of a feedback page in a zip as follows. Moodle (*Upload multiple feedback files in a zip*):
by the folder ``<name>_<number>_assignsubmission_file``. Canvas (*Upload submissions*): by the numbers of the student
and of the file, which are in the file name that Canvas made. Brightspace, Sakai and ILIAS (from memory): by the name of
the student's folder, which the LMS made.
"""

from __future__ import annotations

import io
import unicodedata
import zipfile
from dataclasses import dataclass, replace
from pathlib import PurePath, PurePosixPath
from typing import TYPE_CHECKING

import xlsxwriter

from autograder.grading.classes.class_directory import ClassDirectory
from autograder.grading.collecting.collected_files import CollectedRecords
from autograder.grading.collecting.submitted_file_names import read_lms_name
from autograder.grading.grading_errors import GradingError, check_known, course_command, write_output
from autograder.grading.reporting.class_table import ClassTable, read_table
from autograder.grading.reporting.gradebook_layouts import LAYOUTS, GradebookLayout
from autograder.grading.reporting.lms_gradebooks import fill_list, gradebook, line_from_lms
from autograder.grading.table.rows import COLUMNS, DROPPED, LATE, csv_cells
from autograder.grading.table.spreadsheet_csv import blank, csv_text
from autograder.kit.in_words import counted

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from pathlib import Path


_MOST_NAMED = 20


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
        to: A system in :data:`LAYOUTS`, or ``csv`` or ``xlsx``.
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
            filled, notices = fill_list(into, to, table, wanted, columns or {})
            purpose = f"{to.capitalize()}: your exported list, now with the points of {', '.join(wanted)}"
        parts = [(into.name, filled, purpose)] if into else _files(directory, table, to, wanted, notices)
        for name, data, purpose in parts:
            write_output(folder / name, data, "--output")
            written.append((folder / name, purpose))
    notices += [
        f"{one.label} was not graded, so no points of it are exported: {one.sentence}"
        for one in table.unplaced
    ]
    notices += [
        f"{name} is left out of all students' points: {reason}" for name, reason in table.unusable.items()
    ]
    notices += [*table.notices, *(one for one in table.late_notices([to]) if one not in table.notices)]
    if without := [one for one in table.students if not table.has_points(one, wanted)]:
        notices.append(
            f"{counted(len(without), 'student')} of the class without points for {', '.join(wanted)}: "
            f"{', '.join(without[:_MOST_NAMED])}{' …' if without[_MOST_NAMED:] else ''}"
        )
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
    records, layout = CollectedRecords(directory.state), LAYOUTS.get(to, GradebookLayout())
    if to == "csv":
        yield "students.csv", class_csv(table, assignments), "a line for each student"
    elif to == "xlsx":
        yield (
            "grades.xlsx",
            _class_xlsx(table, assignments),
            "one sheet that lists the students, and one that lists their results in the exercises",
        )
    elif layout.purpose:
        text = gradebook(to, table, records, assignments)
        yield f"{to}.csv", text.encode(), layout.purpose
    else:
        notices.append(f"{to.upper()} cannot import points from a file, so only feedback pages are written")
    for assignment in assignments if layout.pages else ():
        data, unknown = _feedback_zip(directory, table, records, assignment, to)
        if data:
            purpose = f"{to.capitalize()}: the assignment {assignment}, {layout.pages}"
            yield f"feedback-{to}-{assignment}.zip", data, purpose
        if unknown:
            notices.append(
                f"the zip has no feedback on {assignment} for {', '.join(unknown)}: their work was not collected from "
                f"{to.capitalize()}, so the names that {to.capitalize()} gives to these pages are unknown"
            )


_Cells = list[str | float]


def _student_rows(table: ClassTable, assignments: Sequence[str]) -> list[_Cells]:
    """Return a line with the column names, then a line for each student."""
    who = ["student", "first_name", "last_name", "email"]
    rows: list[_Cells] = [
        [*who, *assignments, "total", "max", "late_penalty", "waits_for_a_person", "excused", "dropped"]
    ]
    for student in map(table.roster.students.__getitem__, table.students):
        own = [row for row in table.of(student.id) if row.assignment in assignments]
        rows.append(
            [
                student.id,
                student.first_name,
                student.last_name,
                student.email,
                *(blank(table.score(student.id, name)) for name in assignments),
                blank(table.points(own)),
                sum(row.max_score for row in own),
                -sum(row.score for row in own if row.exercise == LATE),
                sum(row.waits for row in own),
                " ".join(name for name in assignments if table.is_excused(student.id, name)),
                " ".join(row.assignment for row in own if row.exercise == DROPPED),
            ]
        )
    return rows


def class_csv(table: ClassTable, assignments: Sequence[str]) -> bytes:
    """Return the students' lines as CSV, with the mark (BOM) by which Excel recognizes UTF-8."""
    return csv_text(_student_rows(table, assignments)).encode("utf-8-sig")


def _class_xlsx(table: ClassTable, assignments: Sequence[str]) -> bytes:
    """Return a workbook with two sheets: a line for each student, and a line for each result in an exercise."""
    exercises: list[_Cells] = [list(COLUMNS)]
    exercises += [csv_cells(row) for row in table.rows if row.assignment in assignments]
    data = io.BytesIO()
    # A text from a student or an LMS must never become a formula, a link or a number.
    options = {
        "in_memory": True,
        "strings_to_formulas": False,
        "strings_to_urls": False,
        "strings_to_numbers": False,
    }
    with xlsxwriter.Workbook(data, options) as book:
        bold = book.add_format({"bold": True})
        for name, rows in (("students", _student_rows(table, assignments)), ("exercises", exercises)):
            sheet = book.add_worksheet(name)
            for place, row in enumerate(rows):
                sheet.write_row(place, 0, row, None if place else bold)
            sheet.freeze_panes(1, 1)
            sheet.autofit()
    return data.getvalue()


_MADE = (2000, 1, 1, 0, 0, 0)


def _feedback_zip(
    directory: ClassDirectory, table: ClassTable, records: CollectedRecords, assignment: str, lms: str
) -> tuple[bytes, list[str]]:
    """Return the feedback pages of one assignment as a zip, and the students whose page could not be included.

    Args:
        directory: The class.
        table: The table of the class.
        records: The records of what was collected.
        assignment: The assignment's name.
        lms: A system that takes feedback pages.

    Returns:
        The zip, empty if it would contain no page; and the students who have a page but whose name in that LMS is
        unknown.
    """
    data = io.BytesIO()
    unknown = []
    with zipfile.ZipFile(data, "w", zipfile.ZIP_DEFLATED) as archive:
        for student in table.students:
            pages = sorted((directory.path / "feedback" / student / assignment).glob("*.html"))
            if not pages:
                continue
            there = line_from_lms(records, assignment, student, lms)
            if there is None:
                unknown.append(student)
                continue
            for page in pages:
                if lms == "moodle":
                    name = table.roster.students[student].name or student
                    plain = "".join(" " if character in "_/\\" else character for character in name)
                    folder = f"{unicodedata.normalize('NFC', plain)}_{there.number}_assignsubmission_file"
                    called = f"{folder}/{page.name}"
                else:
                    called = _page_name(there.file, lms, page, is_one=len(pages) == 1)
                # The zip contains no time of this machine, so the same class gives the same zip.
                archive.writestr(zipfile.ZipInfo(called, _MADE), page.read_bytes(), zipfile.ZIP_DEFLATED)
    return (data.getvalue() if archive.namelist() else b""), unknown


def _page_name(file: str, lms: str, page: PurePath, *, is_one: bool) -> str:
    """Return the name of a page in the zip, derived from the name that the LMS gave to the student's file or folder.

    If the student handed in a zip that was unpacked, use the folder's name, because the student chose the names in the
    zip.
    """
    parts = PurePosixPath(file).parts
    place, found = next(
        (place, found) for place in range(len(parts)) if (found := read_lms_name(parts, place, lms))
    )
    above, given = "".join(f"{one}/" for one in parts[:place]), parts[place]
    if lms == "canvas":
        return f"{PurePosixPath(given).stem}{'' if is_one else f'_{page.stem}'}.html"
    head = f"{given}/" if place < len(parts) - 1 else given.removesuffix(found.file)
    return f"{above}{head}{LAYOUTS[lms].within}{page.name}"
