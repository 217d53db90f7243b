"""Lists exported by an LMS, filled in with points; among them Moodle's grading worksheet."""

from __future__ import annotations

import csv
import io
from typing import TYPE_CHECKING, NamedTuple

import re2
from rapidfuzz import fuzz

from autograder.grading.collecting.reading.list_forms import EACH, FORMS, ListForm
from autograder.grading.errors import GradingError
from autograder.grading.exporting.layouts import LAYOUTS
from autograder.grading.reporting.spreadsheet import csv_rows, original
from autograder.grading.table.roster import Identity

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from autograder.grading.table.class_table import ClassTable
    from autograder.grading.table.roster import Student


def filled_in(
    data: bytes, lms: str, table: ClassTable, assignments: Sequence[str], columns: Mapping[str, str]
) -> tuple[bytes, list[str], list[str], list[str]]:
    """Fill points into a list that an LMS exported, and leave everything else in the list unchanged.

    Points that are already in the list stay if the class has none for the student.

    Args:
        data: Moodle's grading worksheet, or a gradebook that another system exported.
        lms: The system, as the instructor named it.
        table: The table of the class.
        assignments: The assignments to fill in; exactly one if the list is a worksheet.
        columns: For assignments whose column in the list has another name, that name.

    Returns:
        Four results: the list; the lines that match no student of the class; the lines that may mean a student for
        whom another line is at least as good (in an LMS, users name themselves); and the columns that identify a
        student.

    Raises:
        GradingError: The list cannot be read, is of an unknown kind or from another system, or has no column that
            takes points for an assignment.
    """
    rows, delimiter = csv_rows(data)
    header = [name.strip() for name in rows[0]] if rows else []
    lower = [name.lower() for name in header]
    kinds = [one for one in FORMS if one.points]
    kind = next((one for one in kinds if set(one.has) <= set(lower)), None)
    if kind is None:
        gradebooks = ", ".join(one.lms.capitalize() for one in kinds if one.points == EACH)
        raise GradingError(
            f"The list is neither Moodle's grading worksheet nor a gradebook that {gradebooks} has exported. Download "
            "it from the LMS again."
        )
    if kind.lms != lms:
        raise GradingError(
            f"The list is {kind.lms.capitalize()}'s, and not for --to {lms}: type --to {kind.lms}"
        )
    if kind.points != EACH:
        places = {name: lower.index(kind.points) for name in assignments}
    else:
        open_columns = _open_columns(header, rows[1:], kind)
        places = {name: _column(header, open_columns, name, columns.get(name, name)) for name in assignments}
        _check_one_each(places, header)
    names = (*kind.sure, *kind.names)
    strangers = []
    meant: dict[str, list[_Meant]] = {}
    for row in rows[1:]:
        if not any(row[:1]) or row[0].strip().startswith(("Points Possible", "Student, Test")):
            continue
        # Some spreadsheet programs omit empty cells at the end of a line.
        row += [""] * (len(header) - len(row))
        values = [
            original(row[lower.index(name)].strip()).removeprefix("#") for name in names if name in lower
        ]
        called = values[-1] if values else row[0]
        if (found := _who(table, kind, values)) is None:
            strangers.append(called)
        else:
            student, weakness = found
            meant.setdefault(student.id, []).append(_Meant(weakness, called, row))
    certain, doubtful = _told_apart(meant)
    for student_id, row in certain.items():
        for name, place in places.items():
            if table.is_excused(student_id, name):
                row[place] = LAYOUTS[lms].excused
            elif (score := table.score(student_id, name)) is not None:
                row[place] = f"{score:g}".replace(".", "," if delimiter == ";" else ".")
    sure = [name for name in header if name.lower() in kind.sure]
    out = io.StringIO(newline="")
    csv.writer(out, delimiter=delimiter, lineterminator="\n").writerows(rows)
    mark = "\ufeff" if data.startswith("\ufeff".encode()) else ""
    return f"{mark}{out.getvalue()}".encode(), strangers, doubtful, sure


class _Meant(NamedTuple):
    """A line that matches a student: how weak the match is, the student's name in the line, and the line's cells."""

    weakness: int
    called: str
    row: list[str]


def _told_apart(meant: Mapping[str, Sequence[_Meant]]) -> tuple[dict[str, list[str]], list[str]]:
    """Return the line of each student, and the names in further lines that may mean the same student."""
    certain: dict[str, list[str]] = {}
    doubtful: list[str] = []
    for student, lines in meant.items():
        best, *others = sorted(lines)
        if others and others[0].weakness == best.weakness:
            others = list(lines)
        else:
            certain[student] = best.row
        doubtful += [one.called for one in others]
    return certain, doubtful


_KINDS = ("number", "login", "name")
"""The kinds of values that may identify a student, the most certain first."""


def _open_columns(header: Sequence[str], rows: Sequence[Sequence[str]], kind: ListForm) -> list[int]:
    """Return the indexes of the columns that can take the points of an assignment.

    The other columns are recognized as follows. In the line *Points Possible*, Canvas writes ``(read only)`` into
    each column that it computes itself. Gradescope writes a column ``… - Max Points`` for each assignment.
    """
    ours = map(str.lower, LAYOUTS[kind.lms].columns)
    known = {*kind.has, *kind.logins, *kind.names, *ours, "first name"}
    possible: Sequence[str] = next((row for row in rows if row and row[0].strip() == "Points Possible"), ())
    computed = {
        index for index, cell in enumerate(possible) if cell.strip() and not any(map(str.isdigit, cell))
    }
    found = [
        index for index, name in enumerate(header) if name.lower() not in known and index not in computed
    ]
    scored = [index for index in found if f"{header[index]} - Max Points" in header]
    return scored or found


def _column(header: Sequence[str], open_columns: Sequence[int], assignment: str, called: str) -> int:
    """Return the index of the column for an assignment. Canvas adds a number to its name: ``lab_1_2 (815)``.

    Raises:
        GradingError: The list has no such column, or the LMS computes that column itself.
    """
    named = [i for i, name in enumerate(header) if name == called or _without_number(name) == called]
    for index in named:
        if index in open_columns:
            return index
    problem = (
        f"The column {called} takes no points for an assignment: the system computes it, or it names the student."
        if named
        else f"The list has no column for {called}."
    )
    names = [header[index] for index in open_columns]
    if not names:
        raise GradingError(f"{problem} No column of this list takes points: export it from the LMS again.")
    raise GradingError(
        f"{problem} These take points: {', '.join(names)}. Name one, for example: "
        f'--column "{assignment}={_likeliest(assignment, names)}"'
    )


def _without_number(name: str) -> str:
    """Return a column's name without the suffix that Canvas, Brightspace, Blackboard or Sakai adds."""
    return re2.sub(r"(?: \([^()]*\)| Points Grade.*| \[[^\]]*\](?: \|\d+)?)$", "", name)


def _likeliest(assignment: str, names: Sequence[str]) -> str:
    """Return the column name that is most similar to an assignment's name. Case and punctuation are ignored."""

    def similarity(name: str) -> tuple[float, float]:
        one, other = (re2.sub(r"[\W_]+", "", text).casefold() for text in (assignment, _without_number(name)))
        return fuzz.partial_ratio(one, other), fuzz.ratio(one, other)

    return max(names, key=similarity)


def _check_one_each(places: Mapping[str, int], header: Sequence[str]) -> None:
    """Raise GradingError if two assignments would be written into the same column."""
    for name, index in places.items():
        others = [other for other, place in places.items() if place == index and other != name]
        if others:
            raise GradingError(
                f"{name} and {others[0]} would both be written into {header[index]}: give each its own --column, "
                "or choose one with --assignment."
            )


def _who(table: ClassTable, kind: ListForm, values: Sequence[str]) -> tuple[Student, int] | None:
    """Return the student of a line, and the rank of the matching value; a lower rank is a more certain match."""
    columns: list[tuple[str, tuple[str, ...]]] = [(value, _KINDS) for value in values]
    if kind.is_numbered:
        # A number of the LMS may be another student's id in the class, so it is compared with ids last.
        columns = [(values[0], _KINDS[:1]), *columns[1:], (values[0], _KINDS[1:])]
    for place, (value, kinds) in enumerate(columns):
        for way in kinds if value else ():
            found = table.roster.find(Identity(kind.lms, **{way: value}))
            if len(found) == 1:
                return found[0], place
    return None
