"""The gradebooks of learning management systems (LMS): files with points, for an LMS to import.

Canvas reads ``Student, ID, SIS User ID, SIS Login ID, Section``, then a column for each assignment, and in the second
line the points possible (https://community.canvaslms.com, "How do I import grades in the Gradebook?"). Moodle's
gradebook reads any columns, one of which identifies the student (https://docs.moodle.org, "Grade import").
Brightspace reads ``OrgDefinedId`` or ``Username``, ``… Points Grade`` and an end-of-line marker
(https://community.d2l.com, "Importing grades"). The formats of Blackboard and Sakai are from memory.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from autograder.grading.reporting.gradebook_layouts import LAYOUTS
from autograder.grading.table.spreadsheet_csv import csv_text

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from autograder.grading.collecting.collected_files import CollectedRecords, Line
    from autograder.grading.reporting.class_table import ClassTable


def cell_text(table: ClassTable, lms: str, student: str, assignment: str) -> str | None:
    """Return what the class writes into a student's cell for an assignment; None if it has nothing to write."""
    if table.is_excused(student, assignment):
        return LAYOUTS[lms].excused
    score = table.score(student, assignment)
    return None if score is None else f"{score:g}"


def gradebook(
    lms: str,
    table: ClassTable,
    records: CollectedRecords,
    assignments: Sequence[str],
    names: Mapping[str, str],
) -> str:
    """Return the file to import into the gradebook of an LMS.

    Args:
        lms: A system that takes points from a file.
        table: The table of the class.
        records: The records of what was collected.
        assignments: The assignments, which get a column each.
        names: The names of columns that exist in the LMS, by assignment.
    """
    layout = LAYOUTS[lms]
    points = {name: table.max_score(name) for name in assignments}
    titles = [names.get(name) or layout.points.format(name=name, most=most) for name, most in points.items()]
    rows: list[list[str | float]] = [[*layout.columns, *titles, *layout.end]]
    if layout.possible:
        rows.append([layout.possible, *[""] * (len(layout.columns) - 1), *points.values()])
    for student in map(table.roster.students.__getitem__, table.students):
        collected = (line_from_lms(records, name, student.id, lms) for name in assignments)
        there = student.lms.get(lms, "") or next((one.number or one.name for one in collected if one), "")
        name = ", ".join(filter(None, (student.last_name, student.first_name))) or student.id
        facts = {"student": student, "there": there, "user": there or student.id, "name": name}
        scores = [cell_text(table, lms, student.id, one) or "" for one in assignments]
        about = [template.format_map(facts) for template in layout.columns.values()]
        rows.append([*about, *scores, *layout.end.values()])
    return csv_text(rows)


def line_from_lms(records: CollectedRecords, assignment: str, student: str, lms: str) -> Line | None:
    """Return the line of ``collected.csv`` with a student's names in this LMS; None if the work came from elsewhere."""
    history = records.get(assignment, student)
    found = [one for one in history.now.values() if lms in (one.lms, one.via)] if history else []
    return found[-1] if found else None
