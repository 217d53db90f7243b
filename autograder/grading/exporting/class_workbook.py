"""The table of a class for a spreadsheet: a line for each student, then a line for each exercise."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING

import xlsxwriter

from autograder.grading.reporting.rows import COLUMNS, DROPPED, LATE, csv_cells
from autograder.grading.reporting.spreadsheet import blank, csv_text

if TYPE_CHECKING:
    from collections.abc import Sequence

    from autograder.grading.table.class_table import ClassTable

Cells = list[str | float]


def student_rows(table: ClassTable, assignments: Sequence[str]) -> list[Cells]:
    """Return a line with the column names, then a line for each student."""
    who = ["student", "first_name", "last_name", "email"]
    rows: list[Cells] = [
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


def as_csv(table: ClassTable, assignments: Sequence[str]) -> bytes:
    """Return the students' lines as CSV, with the mark (BOM) by which Excel recognizes UTF-8."""
    return csv_text(student_rows(table, assignments)).encode("utf-8-sig")


def as_xlsx(table: ClassTable, assignments: Sequence[str]) -> bytes:
    """Return a workbook with two sheets: a line for each student, and a line for each result in an exercise."""
    exercises: list[Cells] = [list(COLUMNS)]
    exercises += [list(csv_cells(row)) for row in table.rows if row.assignment in assignments]
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
        for name, rows in (("students", student_rows(table, assignments)), ("exercises", exercises)):
            sheet = book.add_worksheet(name)
            for place, row in enumerate(rows):
                sheet.write_row(place, 0, row, None if place else bold)
            sheet.freeze_panes(1, 1)
            sheet.autofit()
    return data.getvalue()
