"""Writes the files for an LMS or a spreadsheet into the folder ``export`` of the class: points, and feedback pages."""

from __future__ import annotations

import contextlib
import functools
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from autograder.grading.classes.class_directory import ClassDirectory
from autograder.grading.classes.class_file import read_class_file
from autograder.grading.collecting.collected_csv import Table
from autograder.grading.collecting.collected_files import CollectedRecords
from autograder.grading.collecting.lms_lists import number_in
from autograder.grading.collecting.systems import EACH
from autograder.grading.grading_errors import GradingError, check_known, course_command, write_output
from autograder.grading.reporting.class_table import ClassTable, read_table
from autograder.grading.reporting.export_memory import ExportMemory
from autograder.grading.reporting.feedback_zips import pages_for
from autograder.grading.reporting.gradebook_layouts import LAYOUTS, GradebookLayout
from autograder.grading.reporting.list_columns import Called, gradebook_columns
from autograder.grading.reporting.lms_gradebooks import cell_text, gradebook
from autograder.grading.reporting.lms_list_filling import fill_list, read_lms_list
from autograder.grading.table.roster import NAME as ROSTER
from autograder.grading.table.rows import DROPPED, LATE
from autograder.grading.table.spreadsheet_csv import blank, csv_rows, csv_text
from autograder.kit.in_words import counted

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence
    from pathlib import Path

    from autograder.grading.reporting.list_columns import Column
    from autograder.grading.reporting.lms_list_filling import CellChange, LmsList


_MOST_NAMED = 20


@dataclass(frozen=True)
class Exported:
    """The files that an export wrote, or would write.

    Attributes:
        files: Pairs of a file and its purpose.
        notices: Sentences that the instructor should read before uploading.
        changes: The cells of an LMS's list in which the class has other points.
        filled: A sentence for each column of the list that was filled in.
        questions: What the instructor has to decide, each with what to type.
        ungraded: Sentences about collected files that wait for the instructor, so that no points of them are exported.
    """

    files: tuple[tuple[Path, str], ...]
    notices: tuple[str, ...]
    changes: tuple[CellChange, ...] = ()
    filled: tuple[str, ...] = ()
    questions: tuple[str, ...] = ()
    ungraded: tuple[str, ...] = ()

    @property
    def exit_code(self) -> int:
        """2 if the instructor has to decide something; otherwise 0."""
        return 2 if self.questions else 0

    def lines(self) -> Iterator[str]:
        """Yield the lines to print: what changes in the list, the files, the notices and the questions."""
        yield from self.filled
        yield from (f"change       {one.line()}" for one in self.changes if one.before)
        for file, purpose in self.files:
            yield str(file)
            yield f"    {purpose}"
        yield from (f"note         {notice}" for notice in (*self.ungraded, *self.notices))
        yield from (f"waits        {question}" for question in self.questions)


@dataclass(frozen=True)
class ExportChoices:
    """The choices of the instructor for an export.

    Attributes:
        assignments: The assignments to export; all that at least one student has handed in if empty.
        into: A list that the LMS has exported, to be filled in with points.
        folder: The folder to write into; the folder ``export`` in the class if None.
        absent_zero: True to write zero for students who have handed in nothing; False to write nothing for them.
        columns: For assignments whose column in ``into`` has another name, that name.
        sections: The sections whose students are exported; all students if empty.
        over: True to replace what people typed into the LMS.
        dry_run: True to write nothing.
    """

    assignments: Sequence[str] = ()
    into: Path | None = None
    folder: Path | None = None
    absent_zero: bool = False
    columns: Mapping[str, str] = field(default_factory=dict)
    sections: Sequence[str] = ()
    over: bool = False
    dry_run: bool = False


_Part = tuple[str, bytes, str]
"""The name of a file, its content and its purpose."""


def export(path: Path, to: str, choices: ExportChoices = ExportChoices()) -> Exported:
    """Write points and feedback in the format of an LMS.

    Args:
        path: The class directory.
        to: A system in :data:`LAYOUTS`, or ``csv``; empty for the system from which the list comes.
        choices: The choices of the instructor.

    Raises:
        GradingError: There is nothing to export, a grading run is in progress, or the list is missing or cannot be
            filled in.
    """
    if choices.columns and not choices.into:
        raise GradingError(
            "--column names a column of the list in --into: add --into LIST, or leave out --column."
        )
    directory = ClassDirectory(path)
    # The lock excludes a grading run: grades that the run has set to zero would look like results.
    with directory.lock():
        source = read_lms_list(choices.into) if choices.into else None
        if source and to not in ("", source.form.lms):
            raise GradingError(
                f"The list comes from {source.form.lms.capitalize()}, but --to names {to}: type --to {source.form.lms}"
            )
        table = read_table(directory, choices.sections)
        table = replace(table, absent=0.0) if choices.absent_zero else table
        work = _Export(directory, table, ExportMemory(directory.state), choices)
        done = work.into_list(source) if source else work.plain(to)
        notices = [*done.notices, *_notices(table, source.form.lms if source else to, work.wanted, path)]
        ungraded = (
            f"{one.label} was not graded, so no points of it are exported: {one.sentence}"
            for one in table.unplaced
        )
        return replace(done, notices=tuple(notices), ungraded=tuple(ungraded))


@dataclass
class _Export:
    """An export of a class that this process has locked."""

    directory: ClassDirectory
    table: ClassTable
    memory: ExportMemory
    choices: ExportChoices

    @functools.cached_property
    def wanted(self) -> list[str]:
        """The assignments to export.

        Raises:
            GradingError: Nobody has handed in an assignment, or any.
        """
        asked = self.choices.assignments
        check_known(list(self.choices.columns), self.table.assignments, "assignment")
        self.table.check_usable(asked)
        if not self.table.assignments:
            raise GradingError("Nothing was handed in yet, so there is nothing to export.")
        check_known(asked, self.table.assignments, "assignment that a student has handed in")
        return list(asked) or self.table.assignments

    def into_list(self, source: LmsList) -> Exported:
        """Fill a list in."""
        lms = source.form.lms
        wanted = self._of_worksheet(source) or self.wanted
        self.wanted = list(dict.fromkeys([*wanted, *self.choices.columns]))
        done = fill_list(
            source,
            self.table,
            self._called(lms, self.wanted),
            self.memory,
            read_class_file(self.directory.path),
            over=self.choices.over,
        )
        names = ", ".join(done.columns) or "nothing"
        purpose = f"{lms.capitalize()}: your exported list, now with the points of {names}"
        into = source.path
        before = (f"{into.stem}.before{into.suffix}", done.original, "the list as it was")
        notices = list(done.notices)
        pages = pages_for(self.directory, self.table, lms, list(done.columns), notices)
        files = self._write([before, (into.name, done.filled, purpose), *pages])
        for name, points in done.written.items():
            self.memory.note(lms, name, done.columns[name].name if source.form.points == EACH else "", points)
        self._remember()
        if any(one.is_kept for one in done.changes):
            kept = counted(sum(one.is_kept for one in done.changes), "cell")
            notices.append(
                f"{kept} of the list with a value that was typed into the LMS: it stays. To replace these, add --over "
                "(an excused student stays excused)"
            )
        filled = [
            _filled(
                name,
                column,
                self.table.max_score(name),
                [one for one in done.changes if one.assignment == name],
            )
            for name, column in done.columns.items()
        ]
        return Exported(tuple(files), tuple(notices), done.changes, tuple(filled), done.questions)

    def plain(self, to: str) -> Exported:
        """Write files for a system, or for a spreadsheet."""
        notices: list[str] = []
        names = {one.assignment: one.remembered for one in self._called(to, self.wanted) if one.remembered}
        files = self._write(_files(self.directory, self.table, to, self.wanted, notices, names))
        if to in LAYOUTS and LAYOUTS[to].purpose:
            for name in self.wanted:
                cells = {one: cell_text(self.table, to, one, name) for one in self.table.students}
                points = {one: cell for one, cell in cells.items() if cell is not None}
                self.memory.note(to, name, names.get(name, ""), points)
            notices.append(
                f"{to.capitalize()} takes these points instead of what was typed there: a list that "
                f"{to.capitalize()} exported, given with --into, keeps that"
            )
        self._remember()
        return Exported(tuple(files), tuple(notices))

    def _of_worksheet(self, source: LmsList) -> list[str]:
        """Return the assignment whose collected files have the numbers of a worksheet, if there is exactly one."""
        if source.form.points == EACH or self.choices.assignments:
            return []
        numbers = {number_in(value) for value in source.values(source.form.number)}
        lines = Table(self.directory).lines()
        named = {
            one["assignment"]
            for one in lines
            if one["system"] == source.form.lms and one["number"] in numbers
        }
        return sorted(named & set(self.table.assignments)) if len(named) == 1 else []

    def _called(self, lms: str, names: Sequence[str]) -> list[Called]:
        """Return what the columns of assignments may be called, in the order of ``names``."""
        notebooks = {name: self.directory.notebooks(name) for name in names}
        titled = [Called(name, self.directory.title(name, notebooks[name][0])) for name in names]
        with contextlib.suppress(OSError):
            rows, _ = csv_rows((self.directory.path / ROSTER).read_bytes())
            in_students = gradebook_columns(rows, lms, titled)
            titled = [replace(one, remembered=in_students.get(one.assignment, "")) for one in titled]
        return [
            replace(
                one,
                remembered=self.memory.column(lms, one.assignment).name or one.remembered,
                named=self.choices.columns.get(one.assignment, ""),
            )
            for one in titled
        ]

    def _write(self, parts: Iterable[_Part]) -> list[tuple[Path, str]]:
        folder = self.choices.folder or self.directory.path / "export"
        files = []
        for name, data, purpose in parts:
            if not self.choices.dry_run:
                write_output(folder / name, data, "--output")
                files.append((folder / name, purpose))
        return files

    def _remember(self) -> None:
        if not self.choices.dry_run:
            self.memory.write()


def _filled(name: str, column: Column, most: float, changes: Sequence[CellChange]) -> str:
    """Return a sentence about what is filled into a column."""
    kept = sum(one.is_kept for one in changes)
    new = sum(not one.before and not one.is_kept for one in changes)
    replaced = len(changes) - kept - new
    return (
        f"column       {name} → {column.name}, out of {column.out_of or most:g}: {new} new, {replaced} replaced, "
        f"{kept} typed into the LMS and kept"
    )


def _notices(table: ClassTable, lms: str, wanted: Sequence[str], path: Path) -> Iterator[str]:
    """Yield sentences about points that are not exported, or are not final."""
    for name, reason in table.unusable.items():
        yield f"{name} is left out of all students' points: {reason}"
    yield from table.notices
    yield from (one for one in table.late_notices([lms]) if one not in table.notices)
    if without := [one for one in table.students if not table.has_points(one, wanted)]:
        yield (
            f"{counted(len(without), 'student')} of the class without points for {', '.join(wanted)}: "
            f"{', '.join(without[:_MOST_NAMED])}{' …' if without[_MOST_NAMED:] else ''}"
        )
    if table.waiting:
        waiting = counted(len(table.waiting), "result")
        yield f"{waiting} still to be graded by a person, exported with their present points"
    if table.stale:
        yield (
            f"{counted(len(table.stale), 'submission')} without points, or with points of earlier work or of another "
            "version of the course: "
            f"{', '.join(table.stale[:5])}{' …' if len(table.stale) > 5 else ''}. "
            f"Grade first: {course_command('grade', path)}"
        )


def _files(
    directory: ClassDirectory,
    table: ClassTable,
    to: str,
    assignments: Sequence[str],
    notices: list[str],
    names: Mapping[str, str],
) -> Iterator[_Part]:
    layout = LAYOUTS.get(to, GradebookLayout())
    if to == "csv":
        yield "students.csv", class_csv(table, assignments), "a line for each student"
    elif layout.purpose:
        text = gradebook(to, table, CollectedRecords(directory.state), assignments, names)
        yield f"{to}.csv", text.encode(), layout.purpose
    else:
        notices.append(f"{to.upper()} cannot import points from a file, so only feedback pages are written")
    if to in LAYOUTS:
        yield from pages_for(directory, table, to, assignments, notices)


_Cells = list[str | float]


def _student_rows(table: ClassTable, assignments: Sequence[str]) -> list[_Cells]:
    """Return a line with the column names, then a line for each student."""
    who = ["student", "first_name", "last_name", "email"]
    rows: list[_Cells] = [
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


def class_csv(table: ClassTable, assignments: Sequence[str]) -> bytes:
    """Return the students' lines as CSV, with the mark (BOM) by which Excel recognizes UTF-8."""
    return csv_text(_student_rows(table, assignments)).encode("utf-8-sig")
