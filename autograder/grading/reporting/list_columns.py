"""Finds the columns of an LMS's list that take the points of assignments, and the points that each is out of."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import re2

from autograder.grading.collecting.systems import EACH, LIST_FORMS
from autograder.grading.grading_errors import GradingError

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from autograder.grading.collecting.systems import ListForm

_LOCKED = "(read only)"
_POSSIBLE = "Points Possible"
_NUMBER = re2.compile(r"\((\d+)\)$")
# Brightspace, Blackboard and Sakai write the maximum points into the name of a column.
_OUT_OF = re2.compile(r"(?:MaxPoints:|\[(?:Total Pts: (?:up to )?)?)(\d+(?:[.,]\d+)?)")


@dataclass(frozen=True)
class Column:
    """A column for the points of one assignment.

    Attributes:
        place: The index of the column.
        name: The name of the column.
        out_of: The maximum points in the LMS; None if the list does not contain them.
    """

    place: int
    name: str
    out_of: float | None = None


@dataclass(frozen=True)
class FoundColumns:
    """The columns of a list.

    Attributes:
        columns: The column of each assignment that has one.
        question: What the instructor has to say about assignments without a column; empty if there is none.
    """

    columns: Mapping[str, Column] = field(default_factory=dict)
    question: str = ""


@dataclass(frozen=True)
class Called:
    """What a column for an assignment may be called.

    Attributes:
        assignment: The name of the assignment.
        title: The title of the assignment's notebook, such as ``Lab 1.2: A talker and a listener``.
        remembered: The column in an earlier list of the same system; empty if unknown.
        named: The column that the instructor named; empty if none.
    """

    assignment: str
    title: str = ""
    remembered: str = ""
    named: str = ""

    def among(self, names: Sequence[str]) -> list[str]:
        """Return the columns of the assignment, by the first way of comparing names that finds any."""
        if self.named:
            return _same(self.named, names)
        if self.remembered and (found := _same(self.remembered, names)):
            return found
        if found := _same(self.assignment, names):
            return found
        titles = {_letters(one) for one in (self.assignment, self.title, self.title.partition(":")[0])} - {""}
        for way in (_letters, lambda name: _letters(name.partition(":")[0])):
            if found := [name for name in names if way(name) in titles]:
                return found
        return []


def _same(called: str, names: Sequence[str]) -> list[str]:
    """Return the columns with a name, or with its number in Canvas, or else with this name before such a number."""
    if called in names:
        return [called]
    if number := _NUMBER.search(called):
        return [name for name in names if (other := _NUMBER.search(name)) and other[1] == number[1]]
    return [name for name in names if _without_number(name) == called]


def find_columns(rows: Sequence[Sequence[str]], form: ListForm, wanted: Sequence[Called]) -> FoundColumns:
    """Find the column for each assignment.

    Args:
        rows: The rows of the list.
        form: The form of the list, in which each assignment has a column.
        wanted: The assignments.

    Raises:
        GradingError: No assignment has a column, or two have the same.
    """
    header = [name.strip() for name in rows[0]]
    about = {*form.has, *form.sure, *form.names} - {form.points}
    # Canvas marks columns that it computes in the line of the points possible, above which another line may stand.
    locked = {name for row in rows[1:3] for name, cell in zip(header, row, strict=False) if _LOCKED in cell}
    names = [name for name in header if name and name.lower() not in about and name not in locked]
    found = {one.assignment: one.among(names) for one in wanted}
    columns = {
        name: Column(place := header.index(of[0]), of[0], _out_of(of[0], place, rows))
        for name, of in found.items()
        if len(of) == 1
    }
    if len({one.place for one in columns.values()}) < len(columns):
        raise GradingError("Two assignments have the same column: give each its own --column.")
    missing = [one for one in wanted if one.assignment not in columns]
    if not missing:
        return FoundColumns(columns)
    options = " ".join(f'--column "{one.assignment}=COLUMN"' for one in missing)
    asked = ", ".join(one.named or one.assignment for one in missing)
    why = f" {_LOCKED} columns take no points: {', '.join(sorted(locked))}." if locked else ""
    question = (
        f"No column for points is called {asked}, or more than one is. The list has: {', '.join(names) or 'none'}."
        f"{why} Name one for each: {options}"
    )
    if not columns:
        raise GradingError(question)
    return FoundColumns(columns, question)


def _out_of(name: str, place: int, rows: Sequence[Sequence[str]]) -> float | None:
    """Return the maximum points of a column, from the line that Canvas has for them, or from the column's name."""
    cells = [row[place] for row in rows[1:3] if row and row[0].strip() == _POSSIBLE and len(row) > place]
    in_name = _OUT_OF.search(name)
    return number(cells[0] if cells else in_name[1] if in_name else "")


def is_about_no_student(row: Sequence[str]) -> bool:
    """Return True if a line of a list is about no student of the class, such as Canvas's test student."""
    return not any(row[:1]) or row[0].strip().startswith((_POSSIBLE, "Student, Test"))


def number(cell: str) -> float | None:
    """Return the number in a cell, which may have a decimal comma; None if it contains no number."""
    try:
        return float(cell.strip().replace(",", "."))
    except ValueError:
        return None


def gradebook_columns(rows: Sequence[Sequence[str]], lms: str, called: Sequence[Called]) -> dict[str, str]:
    """Return the name of each assignment's column in a list of students, if a gradebook of this LMS is that list."""
    header = {name.strip().lower() for name in rows[0]} if rows else set()
    forms = (one for one in LIST_FORMS if one.lms == lms and one.points == EACH and set(one.has) <= header)
    if (form := next(forms, None)) is None:
        return {}
    try:
        return {name: one.name for name, one in find_columns(rows, form, called).columns.items()}
    except GradingError:
        return {}


def _without_number(name: str) -> str:
    """Return a column's name without the suffix that Canvas, Brightspace, Blackboard or Sakai adds."""
    return re2.sub(r"(?: \([^()]*\)| Points Grade.*| \[[^\]]*\](?: \|\d+)?)$", "", name)


def _letters(name: str) -> str:
    """Return the letters and digits of a name, by which the names of an assignment and of a column are compared."""
    return re2.sub(r"[\W_]+", "", _without_number(name)).casefold()
