"""The formats of the files that learning management systems (LMS) import into their gradebooks.

Canvas reads ``Student, ID, SIS User ID, SIS Login ID, Section``, then a column for each assignment, and in the second
line the points possible (https://community.canvaslms.com, "How do I import grades in the Gradebook?"). Moodle's
gradebook reads any columns, one of which identifies the student (https://docs.moodle.org, "Grade import").
Brightspace reads ``OrgDefinedId`` or ``Username``, ``… Points Grade`` and an end-of-line marker
(https://community.d2l.com, "Importing grades"). The formats of Blackboard and Sakai are from memory.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from autograder.grading.reporting.spreadsheet import blank, csv_text

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from autograder.grading.collecting.line import Line
    from autograder.grading.collecting.records import CollectedRecords
    from autograder.grading.table.class_table import ClassTable


@dataclass(frozen=True)
class GradebookLayout:
    """The format of the gradebook file of one LMS.

    Attributes:
        purpose: The page of the system on which the file is uploaded.
        columns: The columns before the points: each name with the key of its content in :func:`_facts`, or an empty
            text.
        points: A template for the name of an assignment's column, with the assignment's name and maximum points.
        possible: The first cell of the line that contains the maximum points; empty if there is no such line.
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
    "canvas": GradebookLayout(
        "Canvas: Grades, Import",
        {"Student": "name", "ID": "there", "SIS User ID": "", "SIS Login ID": "id", "Section": "section"},
        possible="    Points Possible",
        excused="EX",
    ),
    "moodle": GradebookLayout(
        "Moodle: Grades, Import, CSV file; map Email address and the assignments",
        {"First name": "first", "Last name": "last", "ID number": "id", "Email address": "email"},
    ),
    "blackboard": GradebookLayout(
        "Blackboard: Grade Center > Work Offline > Upload",
        {"Last Name": "last", "First Name": "first", "Username": "user"},
        points="{name} [Total Pts: {most:g} Score]",
    ),
    "brightspace": GradebookLayout(
        "Brightspace: Grades > Enter Grades > Import",
        {"OrgDefinedId": "#id"},
        points="{name} Points Grade",
        end={"End-of-Line Indicator": "#"},
    ),
    "sakai": GradebookLayout(
        "Sakai: Gradebook > Import Grades",
        {"Student ID": "user", "Student Name": "name"},
        points="{name} [{most:g}]",
    ),
}


def known_there(records: CollectedRecords, assignment: str, student: str, lms: str) -> Line | None:
    """Return the line of ``collected.csv`` with a student's names in this LMS; None if the work came from elsewhere."""
    history = records.get(assignment, student)
    found = [one for one in history.now.values() if one.lms == lms] if history else []
    return found[-1] if found else None


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
    collected = (known_there(records, name, id_, lms) for name in assignments)
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
