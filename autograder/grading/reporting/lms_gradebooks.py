"""The gradebooks of learning management systems (LMS): files to import, and exported lists filled in with points.

Canvas reads ``Student, ID, SIS User ID, SIS Login ID, Section``, then a column for each assignment, and in the second
line the points possible (https://community.canvaslms.com, "How do I import grades in the Gradebook?"). Moodle's
gradebook reads any columns, one of which identifies the student (https://docs.moodle.org, "Grade import").
Brightspace reads ``OrgDefinedId`` or ``Username``, ``… Points Grade`` and an end-of-line marker
(https://community.d2l.com, "Importing grades"). The formats of Blackboard and Sakai are from memory. The lists to be
filled in are gradebooks that an LMS has exported, and Moodle's grading worksheet.
"""

from __future__ import annotations

import csv
import io
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import re2
from rapidfuzz import fuzz, process

from autograder.grading.collecting.systems import EACH, LIST_FORMS, ListForm
from autograder.grading.grading_errors import GradingError
from autograder.grading.rebuilding.submitted_notebook import UnreadableSubmission, read_bytes
from autograder.grading.table.roster import Identity
from autograder.grading.table.spreadsheet_csv import blank, csv_rows, csv_text, original

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence
    from pathlib import Path

    from autograder.grading.collecting.collected_files import CollectedRecords, Line
    from autograder.grading.reporting.class_table import ClassTable
    from autograder.grading.table.roster import Student


@dataclass(frozen=True)
class _GradebookLayout:
    """The format of the gradebook file of one LMS.

    Attributes:
        purpose: The page of the system on which the file is uploaded.
        columns: The columns before the points: each name with the key of its content in :func:`_facts`, or an empty
            text.
        points: A template for the name of an assignment's column, with the assignment's name and maximum points.
        possible: The first cell of the line that contains the maximum points; empty if the file has no such line.
        excused: The word with which the system marks an excused student.
        end: The columns after the points, each with its content.
    """

    purpose: str
    columns: Mapping[str, str]
    points: str = "{name}"
    possible: str = ""
    excused: str = ""
    end: Mapping[str, str] = field(default_factory=dict)


LAYOUTS = {
    "canvas": _GradebookLayout(
        "Canvas: Grades, Import",
        {"Student": "name", "ID": "there", "SIS User ID": "", "SIS Login ID": "id", "Section": "section"},
        possible="    Points Possible",
        excused="EX",
    ),
    "moodle": _GradebookLayout(
        "Moodle: Grades, Import, CSV file; map Email address and the assignments",
        {"First name": "first", "Last name": "last", "ID number": "id", "Email address": "email"},
    ),
    "blackboard": _GradebookLayout(
        "Blackboard: Grade Center > Work Offline > Upload",
        {"Last Name": "last", "First Name": "first", "Username": "user"},
        points="{name} [Total Pts: {most:g} Score]",
    ),
    "brightspace": _GradebookLayout(
        "Brightspace: Grades > Enter Grades > Import",
        {"OrgDefinedId": "#id"},
        points="{name} Points Grade",
        end={"End-of-Line Indicator": "#"},
    ),
    "sakai": _GradebookLayout(
        "Sakai: Gradebook > Import Grades",
        {"Student ID": "user", "Student Name": "name"},
        points="{name} [{most:g}]",
    ),
}


def gradebook(lms: str, table: ClassTable, records: CollectedRecords, assignments: Sequence[str]) -> str:
    """Return the file to import into the gradebook of an LMS.

    Args:
        lms: A key of :data:`LAYOUTS`.
        table: The table of the class.
        records: The records of what was collected.
        assignments: The assignments, which get a column each.
    """
    layout = LAYOUTS[lms]
    header: list[str | float] = [*layout.columns]
    possible: list[str | float] = [layout.possible, *[""] * (len(layout.columns) - 1)]
    for name in assignments:
        most = table.max_score(name)
        header.append(layout.points.format(name=name, most=most))
        possible.append(most)
    rows = [[*header, *layout.end], *([possible] if layout.possible else [])]
    for student in table.students:
        facts = _facts(table, records, student, lms, assignments)
        row: list[str | float] = [facts[fact] for fact in layout.columns.values()]
        for name in assignments:
            score = blank(table.score(student, name))
            row.append(layout.excused if layout.excused and table.is_excused(student, name) else score)
        rows.append([*row, *layout.end.values()])
    return csv_text(rows)


def _facts(
    table: ClassTable, records: CollectedRecords, id_: str, lms: str, assignments: Sequence[str]
) -> dict[str, str]:
    """Return the possible contents of a student's cells, by key. ``there`` and ``user`` come from the LMS."""
    student = table.roster.students[id_]
    own = student.lms.get(lms, "")
    collected = (line_from_lms(records, name, id_, lms) for name in assignments)
    there = own or next((one.number or one.name for one in collected if one), "")
    return {
        "": "",
        "id": id_,
        "first": student.first_name,
        "last": student.last_name,
        "name": ", ".join(part for part in (student.last_name, student.first_name) if part) or id_,
        "email": student.email,
        "section": student.section,
        "there": there,
        "user": there or id_,
        "#id": f"#{id_}",
    }


def line_from_lms(records: CollectedRecords, assignment: str, student: str, lms: str) -> Line | None:
    """Return the line of ``collected.csv`` with a student's names in this LMS; None if the work came from elsewhere."""
    history = records.get(assignment, student)
    found = [one for one in history.now.values() if one.lms == lms] if history else []
    return found[-1] if found else None


def fill_list(
    into: Path, lms: str, table: ClassTable, assignments: Sequence[str], columns: Mapping[str, str]
) -> tuple[bytes, list[str]]:
    """Fill points into a list that an LMS exported, and leave everything else in the list unchanged.

    If the class has no points for a student, points that are already in the list stay.

    Args:
        into: Moodle's grading worksheet, or a gradebook that another system exported.
        lms: The system, as the instructor named it.
        table: The table of the class.
        assignments: The assignments to fill in; exactly one if the list is a worksheet.
        columns: For assignments whose column in the list has another name, that name.

    Returns:
        The list, and sentences about lines that were not filled in: they match no student of the class, or they match
        a student no better than another line does. (In an LMS, users name themselves.)

    Raises:
        GradingError: The list cannot be read, is of an unknown kind or from another system, or has no column that
            takes points for an assignment.
    """
    try:
        data = read_bytes(into)
    except UnreadableSubmission as error:
        raise GradingError(f"{into} cannot be read: {error}") from error
    rows, delimiter = csv_rows(data)
    header = [name.strip() for name in rows[0]] if rows else []
    form = _form_of(header, lms)
    places = _point_columns(into, header, form, assignments, columns)
    lines, strangers = _lines_by_student(rows[1:], header, form, table)
    doubtful: list[str] = []
    for student_id, of_student in lines.items():
        (weakness, _, row), *others = sorted(of_student)
        is_certain = all(other > weakness for other, _, _ in others)
        doubtful += [called for _, called, _ in (others if is_certain else of_student)]
        if not is_certain:
            continue
        for name, place in places.items():
            if table.is_excused(student_id, name):
                row[place] = LAYOUTS[lms].excused
            elif (score := table.score(student_id, name)) is not None:
                row[place] = f"{score:g}".replace(".", "," if delimiter == ";" else ".")
    notices = []
    if strangers:
        notices.append(
            f"no student in the class is called {', '.join(strangers)}: their lines stay as they were"
        )
    if doubtful:
        sure = " or ".join(name for name in header if name.lower() in form.sure)
        notices.append(
            f"{', '.join(doubtful)}: each of these lines may belong to the same student as another line, so "
            f"they stay as they were. For each of these students, copy what the list has under {sure} into the column "
            f"{lms} of students.csv"
        )
    out = io.StringIO(newline="")
    csv.writer(out, delimiter=delimiter, lineterminator="\n").writerows(rows)
    mark = "\ufeff" if data.startswith("\ufeff".encode()) else ""
    return f"{mark}{out.getvalue()}".encode(), notices


def _form_of(header: Sequence[str], lms: str) -> ListForm:
    """Return the form of a list with these columns.

    Raises:
        GradingError: The list has no place for points, or it comes from a system other than ``lms``.
    """
    lower = {name.lower() for name in header}
    forms = [one for one in LIST_FORMS if one.points]
    form = next((one for one in forms if set(one.has) <= lower), None)
    if form is None:
        gradebooks = ", ".join(one.lms.capitalize() for one in forms if one.points == EACH)
        raise GradingError(
            f"The list is neither Moodle's grading worksheet nor a gradebook that {gradebooks} has exported. Download "
            "it from the LMS again."
        )
    if form.lms != lms:
        raise GradingError(
            f"The list comes from {form.lms.capitalize()}, but --to names {lms}: type --to {form.lms}"
        )
    return form


def _point_columns(
    into: Path,
    header: Sequence[str],
    form: ListForm,
    assignments: Sequence[str],
    columns: Mapping[str, str],
) -> dict[str, int]:
    """Return the index of the column for points, by assignment.

    Raises:
        GradingError: An assignment has no column of its own.
    """
    if form.points != EACH:
        if len(assignments) != 1:
            raise GradingError(
                f"Say which assignment goes into {into}: --assignment NAME ({', '.join(assignments)})."
            )
        return {assignments[0]: [name.lower() for name in header].index(form.points)}
    places = {name: _column(header, form, name, columns.get(name, name)) for name in assignments}
    if len(set(places.values())) < len(places):
        raise GradingError("Two assignments have the same column: give each its own --column.")
    return places


def _lines_by_student(
    rows: Iterable[list[str]], header: Sequence[str], form: ListForm, table: ClassTable
) -> tuple[dict[str, list[tuple[int, str, list[str]]]], list[str]]:
    """Find the student of each line of a list, and add the empty cells that the line lacks at its end.

    Returns:
        The lines that match each student, by the student's id: the rank of the match, the name in the line, and its
        cells; and the names in the lines that match no student.
    """
    lower = [name.lower() for name in header]
    places = [lower.index(name) for name in (*form.sure, *form.names) if name in lower]
    found: dict[str, list[tuple[int, str, list[str]]]] = {}
    strangers = []
    for row in rows:
        if not any(row[:1]) or row[0].strip().startswith(("Points Possible", "Student, Test")):
            continue
        # Some spreadsheet programs omit empty cells at the end of a line.
        row += [""] * (len(header) - len(row))
        values = [original(row[place].strip()).removeprefix("#") for place in places]
        called = values[-1] if values else row[0]
        if match := _who(table, form, values):
            student, weakness = match
            found.setdefault(student.id, []).append((weakness, called, row))
        else:
            strangers.append(called)
    return found, strangers


def _column(header: Sequence[str], form: ListForm, assignment: str, called: str) -> int:
    """Return the index of an assignment's column. Canvas adds a number to the name of a column: ``lab_1_2 (815)``.

    Raises:
        GradingError: The list has no such column, or the column names the student.
    """
    known = {*form.has, *form.sure, *form.names} - {form.points}
    names = [name for name in header if name.lower() not in known]
    if column := next((name for name in names if called in (name, _without_number(name))), None):
        return header.index(column)
    likeliest = process.extractOne(assignment, names, scorer=fuzz.partial_ratio, processor=_letters)
    raise GradingError(
        f"No column for points is called {called}. The list has: {', '.join(names) or 'none'}. Name one, for example: "
        f'--column "{assignment}={likeliest[0] if likeliest else "COLUMN"}"'
    )


def _without_number(name: str) -> str:
    """Return a column's name without the suffix that Canvas, Brightspace, Blackboard or Sakai adds."""
    return re2.sub(r"(?: \([^()]*\)| Points Grade.*| \[[^\]]*\](?: \|\d+)?)$", "", name)


def _letters(name: str) -> str:
    """Return the letters and digits of a name, by which the names of an assignment and of a column are compared."""
    return re2.sub(r"[\W_]+", "", _without_number(name)).casefold()


_KINDS = ("number", "login", "name")
"""The kinds of values that may identify a student, the most certain first."""


def _who(table: ClassTable, form: ListForm, values: Sequence[str]) -> tuple[Student, int] | None:
    """Return the student of a line, and the rank of the matching value; a lower rank is a more certain match."""
    columns: list[tuple[str, tuple[str, ...]]] = [(value, _KINDS) for value in values]
    if form.is_numbered:
        # A number of the LMS may be another student's id in the class, so the number is compared with ids last.
        columns = [(values[0], _KINDS[:1]), *columns[1:], (values[0], _KINDS[1:])]
    for place, (value, kinds) in enumerate(columns):
        for way in kinds if value else ():
            found = table.roster.find(Identity(form.lms, **{way: value}))
            if len(found) == 1:
                return found[0], place
    return None
