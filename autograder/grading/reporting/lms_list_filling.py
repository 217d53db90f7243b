"""Fills points into lists that learning management systems (LMS) exported: gradebooks, and Moodle's grading worksheet.

Nothing that a person typed into the LMS is lost: each cell that the class would change is shown, and a value that
differs from the one that the class exported last stays.
"""

from __future__ import annotations

import csv
import io
from dataclasses import dataclass
from typing import TYPE_CHECKING

from autograder.grading.collecting.systems import EACH, LIST_FORMS, ListForm
from autograder.grading.grading_errors import GradingError
from autograder.grading.rebuilding.submitted_notebook import UnreadableSubmission, read_bytes
from autograder.grading.reporting.gradebook_layouts import LAYOUTS
from autograder.grading.reporting.list_columns import Column, find_columns, is_about_no_student, number
from autograder.grading.reporting.lms_gradebooks import cell_text
from autograder.grading.table.roster import Identity
from autograder.grading.table.spreadsheet_csv import csv_rows, original

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence
    from pathlib import Path

    from autograder.grading.classes.class_file import ClassFile
    from autograder.grading.reporting.class_table import ClassTable
    from autograder.grading.reporting.export_memory import ExportMemory
    from autograder.grading.reporting.list_columns import Called


@dataclass(frozen=True)
class CellChange:
    """A cell of an LMS's list in which the class has other points than the list.

    Attributes:
        student: The id of the student.
        assignment: The name of the assignment.
        before: The content of the cell in the list.
        after: What the class has for it.
        out_of: The maximum points.
        is_kept: True if the cell stays as it is, because a person typed its content into the LMS.
    """

    student: str
    assignment: str
    before: str
    after: str
    out_of: float
    is_kept: bool = False

    def line(self) -> str:
        """Return the change as a line of text."""
        points = f"{self.before or '–'} → {self.after or '–'} of {self.out_of:g}"
        kept = ": typed into the LMS, and kept" if self.is_kept else ""
        return f"{self.student}  {self.assignment}  {points}{kept}"


@dataclass(frozen=True)
class FilledList:
    """A list of an LMS, filled in with the points of a class.

    Attributes:
        original: The list as it was.
        filled: The list with the points.
        columns: The columns that were filled in, by assignment.
        written: What the class wrote into each column, or left there because it was the same, by student.
        changes: The cells in which the points of the class differ from the list.
        notices: Sentences about lines that were not filled in: they match no student of the class, or they match a
            student no better than another line does. (In an LMS, users name themselves.)
        questions: What the instructor has to decide, each with what to type.
    """

    original: bytes
    filled: bytes
    columns: Mapping[str, Column]
    written: Mapping[str, Mapping[str, str]]
    changes: tuple[CellChange, ...]
    notices: tuple[str, ...]
    questions: tuple[str, ...]


@dataclass(frozen=True)
class LmsList:
    """A list that an LMS exported.

    Attributes:
        path: The file.
        data: The bytes of the file.
        rows: The rows of the list.
        delimiter: The character between two cells.
        form: The form of the list, which takes points.
    """

    path: Path
    data: bytes
    rows: list[list[str]]
    delimiter: str
    form: ListForm

    @property
    def header(self) -> list[str]:
        """The names of the columns."""
        return [name.strip() for name in self.rows[0]]

    def values(self, column: str) -> list[str]:
        """Return the contents of a column."""
        place = [name.lower() for name in self.header].index(column)
        return [row[place].strip() for row in self.rows[1:] if len(row) > place]


def read_lms_list(into: Path) -> LmsList:
    """Read a list into which an LMS takes points.

    Raises:
        GradingError: The list cannot be read, or is of an unknown kind.
    """
    try:
        data = read_bytes(into)
    except UnreadableSubmission as error:
        raise GradingError(f"{into} cannot be read: {error}") from error
    rows, delimiter = csv_rows(data)
    lower = {name.strip().lower() for name in rows[0]} if rows else set()
    form = next((one for one in LIST_FORMS if one.points and set(one.has) <= lower), None)
    if form is None:
        gradebooks = ", ".join(one.lms.capitalize() for one in LIST_FORMS if one.points == EACH)
        raise GradingError(
            f"{into}: the list is neither Moodle's grading worksheet nor a gradebook that {gradebooks} has exported. "
            "Download it from the LMS again."
        )
    return LmsList(into, data, rows, delimiter, form)


def fill_list(
    source: LmsList,
    table: ClassTable,
    wanted: Sequence[Called],
    memory: ExportMemory,
    said: ClassFile,
    *,
    over: bool = False,
) -> FilledList:
    """Fill points into a list that an LMS exported, and leave everything else in the list unchanged.

    If the class has no points for a student, points that are already in the list stay. What a person typed into the LMS
    stays, too: a value that differs from the one that was exported last.

    Args:
        source: Moodle's grading worksheet, or a gradebook that another system exported.
        table: The table of the class.
        wanted: The assignments to fill in; exactly one if the list is a worksheet.
        memory: What was exported earlier.
        said: The content of ``class.toml``.
        over: True to replace values that a person typed into the LMS, other than the word for an excused student.

    Raises:
        GradingError: The list has no column that takes points for an assignment.
    """
    form, rows = source.form, source.rows
    columns, questions = _columns(source, wanted)
    lines, strangers = _lines_by_student(rows[1:], source.header, form, table)
    certain, doubtful = _certain(lines)
    changes: list[CellChange] = []
    written: dict[str, dict[str, str]] = {}
    for name, column in list(columns.items()):
        most = table.max_score(name)
        there = column.out_of or most
        if most and abs(there - said.out_of.get(name, most)) > _ROUNDED and column.out_of is not None:
            questions.append(_other_maximum(name, column, there, most, said, form.lms))
            continue
        last = memory.column(form.lms, name).points
        written[name] = {}
        for student, row in certain.items():
            after, before = cell_text(table, form.lms, student, name), row[column.place].strip()
            before = "" if before.casefold() in _NO_POINTS else before
            if after is None:
                continue
            if not _is_same(before, after):
                kept = _is_typed(before, last.get(student), LAYOUTS[form.lms].excused, over=over)
                changes.append(CellChange(student, name, before, after, there, kept))
                if kept:
                    continue
                row[column.place] = after.replace(".", "," if source.delimiter == ";" else ".")
            written[name][student] = after
    out = io.StringIO(newline="")
    csv.writer(out, delimiter=source.delimiter, lineterminator="\n").writerows(rows)
    mark = "\ufeff" if source.data.startswith("\ufeff".encode()) else ""
    filled = {name: column for name, column in columns.items() if name in written}
    notices = _notices(source, table, list(columns), lines.keys(), strangers, doubtful)
    encoded = f"{mark}{out.getvalue()}".encode()
    return FilledList(source.data, encoded, filled, written, tuple(changes), tuple(notices), tuple(questions))


def _other_maximum(name: str, column: Column, there: float, most: float, said: ClassFile, lms: str) -> str:
    """Return the question about a column whose maximum points are not those of the class."""
    weight = said.weights.get(name, 1.0) * there / most if most else 1.0
    return (
        f"{name} is out of {most:g} in the class and out of {there:g} in the column {column.name}, so the column stays "
        f"as it was. Change the maximum in {lms.capitalize()} and download the list again; or have the points "
        f"multiplied: write {name} = {weight:.6g} under [weights] in class.toml; or have them written as they are: "
        f"write {name} = {there:g} under [out_of]"
    )


_ROUNDED = 0.01
"""The difference of two numbers of points that are equal: an LMS rounds to two decimals."""
_NO_POINTS = ("-", "–", "n/a")


def _is_same(before: str, after: str) -> bool:
    numbers = number(before), number(after)
    if None not in numbers:
        return abs((numbers[0] or 0.0) - (numbers[1] or 0.0)) < _ROUNDED
    return before.casefold() == after.casefold()


def _is_typed(before: str, last: str | None, excused: str, *, over: bool) -> bool:
    """Return True if a person typed the content of a cell into the LMS, so that it has to stay."""
    if not before or (last is not None and _is_same(before, last)):
        return False
    return not over or (bool(excused) and before.casefold() == excused.casefold())


_Lines = dict[str, list[tuple[int, str, list[str]]]]


def _certain(lines: _Lines) -> tuple[dict[str, list[str]], list[str]]:
    """Return the line of each student of whom one line matches best, and the names in the other lines."""
    certain: dict[str, list[str]] = {}
    doubtful: list[str] = []
    for student, of_student in lines.items():
        (weakness, _, row), *others = sorted(of_student)
        is_certain = all(other > weakness for other, _, _ in others)
        doubtful += [called for _, called, _ in (others if is_certain else of_student)]
        certain |= {student: row} if is_certain else {}
    return certain, doubtful


def _notices(
    source: LmsList,
    table: ClassTable,
    assignments: Sequence[str],
    with_line: Iterable[str],
    strangers: Sequence[str],
    doubtful: Sequence[str],
) -> Iterator[str]:
    """Yield sentences about students without a line, and lines without a student."""
    there = set(with_line)
    if left_out := [one for one in table.students if one not in there and table.has_points(one, assignments)]:
        yield (
            f"the list has no line for {', '.join(left_out)}, so their points are not in it: if they are in the "
            "course, download the list again"
        )
    if strangers:
        yield f"no student in the class is called {', '.join(strangers)}: their lines stay as they were"
    if doubtful:
        sure = " or ".join(name for name in source.header if name.lower() in source.form.sure)
        yield (
            f"{', '.join(doubtful)}: each of these lines may belong to the same student as another line, so "
            f"they stay as they were. For each of these students, copy what the list has under {sure} into the column "
            f"{source.form.lms} of students.csv"
        )


def _columns(source: LmsList, wanted: Sequence[Called]) -> tuple[Mapping[str, Column], list[str]]:
    """Return the columns for points by assignment, and questions about assignments without a column.

    Raises:
        GradingError: No assignment has a column, or several are for the only column of a worksheet.
    """
    form = source.form
    if form.points == EACH:
        found = find_columns(source.rows, form, wanted)
        return found.columns, [found.question] if found.question else []
    if len(wanted) != 1:
        names = ", ".join(one.assignment for one in wanted)
        raise GradingError(f"Say which assignment goes into {source.path}: --assignment NAME ({names}).")
    place = [name.lower() for name in source.header].index(form.points)
    most = source.values(form.out_of) if form.out_of in map(str.lower, source.header) else []
    out_of = next((worth for cell in most if (worth := number(cell)) is not None), None)
    return {wanted[0].assignment: Column(place, source.header[place], out_of)}, []


def _lines_by_student(
    rows: Iterable[list[str]], header: Sequence[str], form: ListForm, table: ClassTable
) -> tuple[_Lines, list[str]]:
    """Find the student of each line of a list, and add the empty cells that the line lacks at its end.

    Returns:
        The lines that match each student, by the student's id: the rank of the match, the name in the line, and its
        cells; and the names in the lines that match no student.
    """
    lower = [name.lower() for name in header]
    places = [lower.index(name) for name in (*form.sure, *form.names) if name in lower]
    found: _Lines = {}
    strangers = []
    for row in rows:
        if is_about_no_student(row):
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


def _identities(form: ListForm, values: Sequence[str]) -> list[Identity]:
    """Return what the values in a line may be of the student, the most certain first."""
    identities = [Identity(form.lms, value, value, value) for value in values]
    if not form.is_numbered:
        return identities
    # A number of the LMS may be another student's id in the class, so the number is compared with ids last.
    number = values[0]
    return [Identity(form.lms, number), *identities[1:], Identity(form.lms, "", number, number)]
