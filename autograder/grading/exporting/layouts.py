"""The files in which systems take points for a whole gradebook: one row of a table for each system.

Canvas reads ``Student, ID, SIS User ID, SIS Login ID, Section``, then a column for each assignment, and in the second
line the points possible (https://community.canvaslms.com, "How do I import grades in the Gradebook?"). Moodle's
gradebook reads any columns, of which one names the student (https://docs.moodle.org, "Grade import"). Brightspace reads
``OrgDefinedId`` or ``Username``, ``… Points Grade`` and a mark at the end (https://community.d2l.com, "Importing
grades"). Gradescope imports none: programs for its lists read this form. Blackboard's and Sakai's are from memory.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from autograder.grading.reporting.spreadsheet import blank, csv_text

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from autograder.grading.collecting.records import Collected, CollectedRecords
    from autograder.grading.table.class_table import ClassTable


@dataclass(frozen=True)
class Layout:
    """The gradebook file of one system.

    Attributes:
        purpose: Where it is uploaded.
        columns: The names of the columns before the points, with what each has of a student: a name of
            :func:`_facts`, or nothing.
        points: The name of the column of an assignment, by its name and most points.
        most: The name of a second column with the most points; empty for none.
        possible: What the line with the most points begins with; empty if there is no such line.
        excused: The word that the system reads as excused.
        end: Columns behind the points, with what each has.
    """

    purpose: str
    columns: Mapping[str, str]
    points: str = "{name}"
    most: str = ""
    possible: str = ""
    excused: str = ""
    end: Mapping[str, str] = field(default_factory=dict)


LAYOUTS = {
    "canvas": Layout(
        "Canvas: Grades, Import",
        {"Student": "name", "ID": "there", "SIS User ID": "", "SIS Login ID": "id", "Section": "section"},
        possible="    Points Possible",
        excused="EX",
    ),
    "moodle": Layout(
        "Moodle: Grades, Import, CSV file; map Email address and the assignments",
        {"First name": "first", "Last name": "last", "ID number": "id", "Email address": "email"},
    ),
    "gradescope": Layout(
        "the scores in the form in which Gradescope exports them",
        {"First Name": "first", "Last Name": "last", "SID": "id", "Email": "email"},
        most="{name} - Max Points",
    ),
    "blackboard": Layout(
        "Blackboard: Grade Center, Work Offline, Upload",
        {"Last Name": "last", "First Name": "first", "Username": "user"},
        points="{name} [Total Pts: {most:g} Score]",
    ),
    "brightspace": Layout(
        "Brightspace: Grades, Enter Grades, Import",
        {"OrgDefinedId": "#id"},
        points="{name} Points Grade",
        end={"End-of-Line Indicator": "#"},
    ),
    "sakai": Layout(
        "Sakai: Gradebook, Import Grades",
        {"Student ID": "user", "Student Name": "name"},
        points="{name} [{most:g}]",
    ),
}


def known_there(records: CollectedRecords, assignment: str, student: str, lms: str) -> Collected | None:
    """The name of a student in the LMS from which work was collected; None if it came another way."""
    history = records.get(assignment, student)
    found = [one for one in history.now.values() if one.lms == lms] if history else []
    return found[-1] if found else None


def gradebook(lms: str, table: ClassTable, records: CollectedRecords, assignments: Sequence[str]) -> str:
    """The file that the gradebook of a system takes."""
    layout = LAYOUTS[lms]
    header: list[str | float] = [*layout.columns]
    possible: list[str | float] = [layout.possible, *[""] * (len(layout.columns) - 1)]
    for name in assignments:
        most = table.max_score(name)
        header += [title.format(name=name, most=most) for title in (layout.points, layout.most) if title]
        possible.append(most)
    rows = [[*header, *layout.end], *([possible] if layout.possible else [])]
    for student in table.students:
        facts = _facts(table, records, student, lms, assignments)
        row: list[str | float] = [facts[fact] for fact in layout.columns.values()]
        for name in assignments:
            score = blank(table.score(student, name))
            row.append(layout.excused if layout.excused and table.is_excused(student, name) else score)
            row += [table.max_score(name)] if layout.most else []
        rows.append([*row, *layout.end.values()])
    return csv_text(rows)


def _facts(
    table: ClassTable, records: CollectedRecords, id_: str, lms: str, assignments: Sequence[str]
) -> dict[str, str]:
    """What a file may have of a student; ``there`` and ``user`` are what the system itself calls the student."""
    student = table.roster.students[id_]
    own = student.lms.get(lms, "")
    is_asked = {"there", "user"} & set(LAYOUTS[lms].columns.values())
    collected = (known_there(records, name, id_, lms) for name in assignments if is_asked)
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
