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
from typing import TYPE_CHECKING

import re2
from rapidfuzz import fuzz, process

from autograder.grading.collecting.systems import EACH, LIST_FORMS, ListForm
from autograder.grading.grading_errors import GradingError
from autograder.grading.rebuilding.submitted_notebook import UnreadableSubmission, read_bytes
from autograder.grading.reporting.gradebook_layouts import LAYOUTS
from autograder.grading.table.roster import Identity
from autograder.grading.table.spreadsheet_csv import blank, csv_rows, csv_text, original

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence
    from pathlib import Path

    from autograder.grading.collecting.collected_files import CollectedRecords, Line
    from autograder.grading.reporting.class_table import ClassTable


_LOCKED = "(read only)"


def gradebook(lms: str, table: ClassTable, records: CollectedRecords, assignments: Sequence[str]) -> str:
    """Return the file to import into the gradebook of an LMS.

    Args:
        lms: A system that takes points from a file.
        table: The table of the class.
        records: The records of what was collected.
        assignments: The assignments, which get a column each.
    """
    layout = LAYOUTS[lms]
    points = {name: table.max_score(name) for name in assignments}
    titles = [layout.points.format(name=name, most=most) for name, most in points.items()]
    rows: list[list[str | float]] = [[*layout.columns, *titles, *layout.end]]
    if layout.possible:
        rows.append([layout.possible, *[""] * (len(layout.columns) - 1), *points.values()])
    for student in map(table.roster.students.__getitem__, table.students):
        collected = (line_from_lms(records, name, student.id, lms) for name in assignments)
        there = student.lms.get(lms, "") or next((one.number or one.name for one in collected if one), "")
        name = ", ".join(filter(None, (student.last_name, student.first_name))) or student.id
        facts = {"student": student, "there": there, "user": there or student.id, "name": name}
        scores = [
            layout.excused if table.is_excused(student.id, one) else blank(table.score(student.id, one))
            for one in assignments
        ]
        about = [template.format_map(facts) for template in layout.columns.values()]
        rows.append([*about, *scores, *layout.end.values()])
    return csv_text(rows)


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
    places = _point_columns(into, rows, form, assignments, columns)
    lines, strangers = _lines_by_student(rows[1:], header, form, table)
    doubtful: list[str] = []
    for student_id, of_student in lines.items():
        (weakness, _, row), *others = sorted(of_student)
        is_certain = all(other > weakness for other, _, _ in others)
        doubtful += [called for _, called, _ in (others if is_certain else of_student)]
        for name, place in places.items() if is_certain else ():
            if table.is_excused(student_id, name):
                row[place] = LAYOUTS[lms].excused
            elif (score := table.score(student_id, name)) is not None:
                row[place] = f"{score:g}".replace(".", "," if delimiter == ";" else ".")
    notices = []
    if left_out := [one for one in table.students if one not in lines and table.has_points(one, assignments)]:
        notices.append(
            f"the list has no line for {', '.join(left_out)}, so their points are not in it: if they are in the "
            "course, download the list again"
        )
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
    form = next((one for one in LIST_FORMS if one.points and set(one.has) <= lower), None)
    if form is None:
        gradebooks = ", ".join(one.lms.capitalize() for one in LIST_FORMS if one.points == EACH)
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
    rows: Sequence[Sequence[str]],
    form: ListForm,
    assignments: Sequence[str],
    columns: Mapping[str, str],
) -> dict[str, int]:
    """Return the index of the column for points, by assignment.

    A column of an assignment has the assignment's name, or its title as in ``Lab 1.2: A talker and a listener``.

    Raises:
        GradingError: An assignment has no column of its own.
    """
    header = [name.strip() for name in rows[0]]
    if form.points != EACH:
        if len(assignments) != 1:
            raise GradingError(
                f"Say which assignment goes into {into}: --assignment NAME ({', '.join(assignments)})."
            )
        return {assignments[0]: [name.lower() for name in header].index(form.points)}
    about = {*form.has, *form.sure, *form.names} - {form.points}
    # Canvas marks columns that it computes in the line of the points possible, above which another line may stand.
    locked = {name for row in rows[1:3] for name, cell in zip(header, row, strict=False) if _LOCKED in cell}
    names = [name for name in header if name and name.lower() not in about and name not in locked]
    found = {
        one: _columns_called(columns.get(one, one), names, is_exact=one in columns) for one in assignments
    }
    if missing := [one for one in assignments if len(found[one]) != 1]:
        likeliest = (
            process.extractOne(one, names, scorer=fuzz.partial_ratio, processor=_letters) for one in missing
        )
        advised = [match[0] if match else "COLUMN" for match in likeliest]
        options = " ".join(f'--column "{one}={name}"' for one, name in zip(missing, advised, strict=True))
        asked = ", ".join(columns.get(one, one) for one in missing)
        why = f" {_LOCKED} columns take no points: {', '.join(sorted(locked))}." if locked else ""
        raise GradingError(
            f"No column for points is called {asked}, or more than one is. The list has: {', '.join(names) or 'none'}."
            f"{why} Name one for each, for example: {options}"
        )
    places = {one: header.index(name) for one, (name,) in found.items()}
    if len(set(places.values())) < len(places):
        raise GradingError("Two assignments have the same column: give each its own --column.")
    return places


def _columns_called(called: str, names: Sequence[str], *, is_exact: bool) -> list[str]:
    """Return the columns with a name, by the first way of comparing names that finds any.

    Args:
        called: The name of a column, or of an assignment.
        names: The names of all columns for points. Canvas adds a number to them: ``lab_1_2 (815)``.
        is_exact: True if a person wrote the name, so that it is compared as it is.
    """
    alike = (_letters, lambda name: _letters(name.partition(":")[0]))
    for way in (str, _without_number) if is_exact else (str, _without_number, *alike):
        if found := [name for name in names if way(name) == (_letters(called) if way in alike else called)]:
            return found
    return []


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
        student, weakness = table.roster.first(_identities(form, values)) or (None, 0)
        if student:
            found.setdefault(student.id, []).append((weakness, called, row))
        else:
            strangers.append(called)
    return found, strangers


def _without_number(name: str) -> str:
    """Return a column's name without the suffix that Canvas, Brightspace, Blackboard or Sakai adds."""
    return re2.sub(r"(?: \([^()]*\)| Points Grade.*| \[[^\]]*\](?: \|\d+)?)$", "", name)


def _letters(name: str) -> str:
    """Return the letters and digits of a name, by which the names of an assignment and of a column are compared."""
    return re2.sub(r"[\W_]+", "", _without_number(name)).casefold()


def _identities(form: ListForm, values: Sequence[str]) -> list[Identity]:
    """Return what the values in a line may be of the student, the most certain first."""
    identities = [Identity(form.lms, value, value, value) for value in values]
    if not form.is_numbered:
        return identities
    # A number of the LMS may be another student's id in the class, so the number is compared with ids last.
    number = values[0]
    return [Identity(form.lms, number), *identities[1:], Identity(form.lms, "", number, number)]
