"""Reads the file ``students.csv`` of a class: in our own form, or as Canvas, Moodle or Gradescope exports it."""

from __future__ import annotations

import itertools
import unicodedata
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import msgspec

from autograder.grading.classes.student_folders import reason_against_name
from autograder.grading.grading_errors import GradingError
from autograder.grading.table.roster import COLUMNS, LMS, Student
from autograder.grading.table.spreadsheet_csv import csv_rows, original

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence


class _Exported(msgspec.Struct):
    has: tuple[str, ...]
    columns: dict[str, tuple[str, ...]]


class _Forms(msgspec.Struct):
    other_names: dict[str, str]
    exported: tuple[_Exported, ...]


_FORMS = msgspec.toml.decode(Path(__file__).with_suffix(".toml").read_bytes(), type=_Forms)
_NOBODY = ("points possible", "student, test")


@dataclass(frozen=True)
class StudentsFile:
    """The content of ``students.csv``.

    Attributes:
        students: The students, in the order of the file.
        unknown: The names of the columns that have no meaning.
    """

    students: tuple[Student, ...] = ()
    unknown: tuple[str, ...] = ()


def read_students_csv(path: Path) -> StudentsFile:
    """Read a list of students. If the file does not exist, the list is empty.

    Raises:
        GradingError: The file cannot be read, the column ``id`` is missing, a column stands twice, or an id or a number
            is missing, invalid, or that of two students.
    """
    try:
        header, *rows = csv_rows(path.read_bytes())[0] or [[]]
    except FileNotFoundError:
        return StudentsFile()
    except OSError as error:
        raise GradingError(f"{path} cannot be read: {error}.") from error
    columns = [name.strip().lower() for name in header]
    forms = (form.columns for form in _FORMS.exported if set(form.has) <= set(columns))
    # A list with an id and an address is our own, whatever else it has: Moodle has no column that is called only id.
    form = next((one for one in forms if "canvas" in one or "id" not in columns), None)
    known: Sequence[str] = [name for theirs in form.values() for name in theirs] if form else ()
    if form is None:
        columns = [name.replace(" ", "_").replace("-", "_") for name in columns]
        columns = [_FORMS.other_names.get(name, name) for name in columns]
        known = ("id",) if "id" not in columns else [name for name in columns if name]
    _check_columns(path, header, columns, known)
    for number, row in enumerate(rows, 2):
        again = [
            cell.strip().lower() == name.strip().lower() for cell, name in zip(row, header, strict=False)
        ]
        if row and row[0].strip() and sum(again) * 2 > len(header):
            raise GradingError(
                f"{path}, line {number}: the names of the columns stand there again. A list of students is one table: "
                "remove this line and, if another table begins there, that table."
            )
    lines = [
        dict(
            itertools.zip_longest(
                columns, (original(cell).strip() for cell in row[: len(columns)]), fillvalue=""
            )
        )
        for row in rows
    ]
    students = _students(path, [_as_ours(line, form) for line in lines] if form else lines)
    unknown = [name for name, column in zip(header, columns, strict=True) if column not in ("", *COLUMNS)]
    return StudentsFile(tuple(students), () if form else tuple(unknown))


def _check_columns(path: Path, header: Sequence[str], columns: Sequence[str], known: Sequence[str]) -> None:
    """Check that the file has a column ``id``, and that no column with a meaning stands twice.

    Raises:
        GradingError: It is not so.
    """
    need = (
        f"The first line has to contain the names of the columns: id and, if you have them, {', '.join(COLUMNS[1:])}. "
        "You can also use Canvas's gradebook, Moodle's participants or Gradescope's roster without changes."
    )
    often = Counter(name for name in columns if name in known)
    if known == ("id",):
        names = ", ".join(name.strip() for name in header if name.strip()) or "nothing"
        raise GradingError(f"{path} has no column named id, but {names}. {need}")
    for name, count in often.items():
        if count > 1:
            places = ", ".join(str(place) for place, one in enumerate(columns, 1) if one == name)
            raise GradingError(f"{path} has {count} columns named {name}: columns {places}. {need}")


def _students(path: Path, lines: Sequence[Mapping[str, str]]) -> list[Student]:
    """Return the students of lines with our own columns.

    Raises:
        GradingError: An id or a number is missing, invalid, or that of two students.
    """
    ids: dict[str, int] = {}
    numbers: dict[tuple[str, str], int] = {}
    found = []
    for line, row in enumerate(lines, 2):
        values = {name: unicodedata.normalize("NFC", cell) for name, cell in row.items()}
        if not any(values.values()):
            continue
        name = values["id"]
        reason = "it has no id" if not name else reason_against_name(name)
        earlier = ids.setdefault(name.casefold(), line)
        if earlier != line:
            reason = f"the id {name} also stands in line {earlier}"
        lms = {column: value for column, value in values.items() if value and column not in _ABOUT}
        first, last, email = (values.get(column, "") for column in ("first_name", "last_name", "email"))
        excused = values.get("excused", "").replace(",", " ").replace(";", " ").split()
        student = Student(name, first, last, email, lms, tuple(excused), values.get("section", ""))
        for system, number in sorted(student.numbers):
            earlier = numbers.setdefault((system, number), line)
            if earlier != line and not reason:
                reason = (
                    f"{values[system]} under {system} also stands in line {earlier}: each student has another"
                )
        if reason:
            raise GradingError(f"{path}, line {line}: {reason}.")
        found.append(student)
    return found


_ABOUT = COLUMNS[: -len(LMS)]


def _as_ours(line: Mapping[str, str], form: Mapping[str, tuple[str, ...]]) -> dict[str, str]:
    """Convert a line of an LMS's list to the columns of ``students.csv``; return {} for a line about no person."""
    values = {ours: next(filter(None, map(line.get, theirs)), "") or "" for ours, theirs in form.items()}
    full = values.pop("full_name", "")
    if full.lower().startswith(_NOBODY):
        return {}
    if full:
        last, comma, first = full.rpartition(",")  # a last name may have a comma, as in "Jones, Jr., Jo"
        first, last = (first, last) if comma else full.rpartition(" ")[::2]
        values |= {"first_name": first.strip(), "last_name": last.strip()}
    if not values.get("email") and "@" in values["id"]:
        values["email"] = values["id"]
    own = {name: line[name] for name in (*LMS, "section", "excused") if line.get(name)}
    return {**values, **own}
