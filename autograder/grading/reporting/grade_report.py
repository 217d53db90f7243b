"""The result of a grading run: as an object, as the JSON of ``grade --json``, and as a table in the terminal."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from itertools import groupby
from typing import TYPE_CHECKING, Any, Self

import msgspec
from rich import box
from rich.cells import cell_len
from rich.table import Table
from rich.text import Text

from autograder import standard_output
from autograder.grading.grading_errors import course_command
from autograder.grading.grading_task import UNREADABLE
from autograder.grading.running.batch_progress import plain_line
from autograder.grading.table.rows import (
    DROPPED,
    EXCUSED,
    LATE,
    NO_EXERCISE,
    NOT_SUBMITTED,
    WAITS,
    Row,
    columns,
    grouped,
    remarks_on,
    total,
)
from autograder.grading.tasks.fallen_points import questions
from autograder.kit.in_words import counted
from autograder.safe_files import name_as_text
from autograder.standard_output import printable
from autograder.verdict import State

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from datetime import datetime
    from pathlib import Path

    from rich.console import Console

    from autograder.grading.classes.student_folders import RefusedFile
    from autograder.grading.reporting.class_table import ClassTable, Difference
    from autograder.grading.tasks.fallen_points import FallenResult


_FORM = 3
"""The version of the JSON format. It increases when a field is renamed or removed."""


@dataclass(frozen=True)
class GradeReport:
    """The result of a grading run.

    Attributes:
        path: The class directory.
        rows: The rows, sorted by student and then in the order of the course.
        refused: Files and folders in ``submitted`` that cannot be graded, each with the reason.
        problems: Sentences about other failures, for which no student has points.
        notices: Sentences for the instructor that are not about a failure.
        would_change: After a dry run, the points that would change; None if points were entered.
        executed: The number of notebooks that were executed.
        run_again: The number of notebooks that were executed again, by the reason.
        fallen: The points that fell although the same files were handed in, and wait for the instructor's yes.
        moved: The points of unchanged submissions that differ from those of the run before.
        reused: The number of notebooks whose result was already known.
        written: The number of submissions that this run entered into the gradebook.
        seconds: The duration of the run, in seconds of wall time.
        timings: When the first notebook began, and when the last one ended, in seconds since the start of the run.
        note: A warning if submissions were run without a sandbox, so that the points may be forged; otherwise empty.
        gradebook: The path of the gradebook's SQLite file; None if the gradebook is on a database server.
        due: The due date of each assignment that has one, in the time zone of the class.
    """

    path: Path
    rows: tuple[Row, ...]
    refused: tuple[RefusedFile, ...] = ()
    problems: tuple[str, ...] = ()
    notices: tuple[str, ...] = ()
    would_change: tuple[Difference, ...] | None = None
    executed: int = 0
    run_again: Mapping[str, int] = field(default_factory=dict)
    fallen: tuple[FallenResult, ...] = ()
    moved: tuple[Difference, ...] = ()
    reused: int = 0
    written: int = 0
    seconds: float = 0.0
    timings: Mapping[str, float] = field(default_factory=dict)
    note: str = ""
    gradebook: Path | None = None
    due: Mapping[str, datetime] = field(default_factory=dict)

    @property
    def csv(self) -> Path:
        """The path of ``grades.csv``, which contains all rows."""
        return self.path / "grades.csv"

    @property
    def feedback(self) -> Path:
        """The folder with the feedback pages for students."""
        return self.path / "feedback"

    @property
    def exit_code(self) -> int:
        """The command's exit code: 0 if everything was graded; 2 if something was not, or waits for the instructor."""
        unchecked = any(row.state == State.NOT_CHECKED for row in self.rows)
        return 2 if self.refused or self.problems or unchecked or self.fallen else 0


def report_json(report: GradeReport) -> bytes:
    """Return the report as one line of JSON."""
    return msgspec.json.encode(
        {
            "form": _FORM,
            "class": str(report.path),
            "exit_code": report.exit_code,
            "note": report.note,
            "submissions": _submissions(report.rows),
            "refused": [
                {"path": name_as_text(str(refused.path)), "reason": name_as_text(refused.reason)}
                for refused in report.refused
            ],
            "problems": [name_as_text(text) for text in report.problems],
            "due": report.due,
            "notices": [name_as_text(text) for text in report.notices],
            "would_change": report.would_change,
            "run_again": report.run_again,
            "fallen": report.fallen,
            "moved": report.moved,
            "totals": {
                "executed": report.executed,
                "reused": report.reused,
                "written": report.written,
                "score": sum(row.score for row in report.rows),
                "max_score": sum(row.max_score for row in report.rows),
                "waiting_for_a_person": sum(row.waits for row in report.rows),
                "not_checked": sum(row.state == State.NOT_CHECKED for row in report.rows),
                "seconds": round(report.seconds, 3),
            },
            "timings": {name: round(value, 3) for name, value in report.timings.items()},
        }
    )


def table_json(page: Path, table: ClassTable) -> bytes:
    """Return a class's table of results and the path of the report page as one line of JSON."""
    return msgspec.json.encode(
        {
            "form": _FORM,
            "page": str(page),
            "submissions": _submissions(table.rows),
            "waiting": [{"file": one.label, "reason": one.sentence} for one in table.unplaced],
            "not_graded": table.stale,
            "notices": table.notices,
        }
    )


def _submissions(rows: tuple[Row, ...]) -> list[dict[str, Any]]:
    """Return a JSON object for each submission, in the order of the rows."""
    found = []
    for (student, assignment), group in groupby(rows, key=lambda row: (row.student, row.assignment)):
        all_rows = list(group)
        exercises = [row for row in all_rows if row.exercise != DROPPED]
        found.append(
            {
                "student": student,
                "name": exercises[0].name,
                "assignment": assignment,
                "score": total(exercises),
                "max_score": sum(row.max_score for row in exercises),
                "is_dropped": exercises != all_rows,
                "remarks": remarks_on(all_rows).get((student, assignment), ""),
                "late_penalty": -sum(row.score for row in exercises if row.exercise == LATE),
                "exercises": [
                    {
                        "exercise": row.exercise,
                        "score": row.shown_score,
                        "max_score": row.max_score,
                        "state": row.state,
                        "diagnosis": row.diagnosis,
                        "reason": row.reason,
                        "judge": row.judged,
                        "by_hand": row.by_hand,
                        "extra": row.extra,
                        "waits_for_a_person": row.waits,
                    }
                    for row in exercises
                    if row.exercise not in NO_EXERCISE
                ],
            }
        )
    return found


_NAME = 30
"""The maximum width of a student's id or name, in characters. Longer ids and names are wrapped."""
_ANY_WIDTH = 10_000
_FOLDED = {"overflow": "fold", "max_width": _NAME}
_RIGHT = {"justify": "right", "no_wrap": True}
_STYLES = {State.PASSED: "green", State.FAILED: "red", State.NOT_CHECKED: "yellow", WAITS: "yellow"}


def show(report: GradeReport, console: Console | None = None, *, with_waiting: bool = True) -> None:
    """Print the table of results, lines about refused files and problems, and the paths of written files.

    Args:
        report: The result of the run.
        console: The console to print on; by default standard output.
        with_waiting: True to print the files that wait for the instructor, too.
    """
    console = console or standard_output.console()
    for question in questions(report.fallen, course_command("grade", report.path)):
        plain_line(console, f"fell         {question}", "yellow")
    for change in report.moved:
        plain_line(console, f"moved        {change.line()}")
    if not report.rows:
        submitted = _near(report.path / "submitted")
        plain_line(console, f"Nothing was submitted: put notebooks into {submitted}/<student>/<assignment>/.")
    else:
        console.print(*tables(report.rows, console))
        console.print(_diagnoses(report.rows))
    for word, text, style in _lines(report, with_waiting=with_waiting):
        plain_line(console, f"{word:<12} {text}" if word else text, style)
    ran, entered = counted(report.executed, "notebook"), counted(report.written, "submission")
    plain_line(console, f"{ran} run, {report.reused} unchanged, {entered} entered, {report.seconds:.1f} s")
    for name, path in (
        ("gradebook", report.gradebook),
        ("grades", report.csv),
        ("feedback", report.feedback),
    ):
        if path and path.exists():
            plain_line(console, f"{name:<10} {_near(path)}")


def _lines(report: GradeReport, *, with_waiting: bool) -> Iterator[tuple[str, str, str]]:
    """Yield the word that begins each line below the table, the text of the line, and the style."""
    if report.would_change is not None:
        count = len(report.would_change)
        found = f"{counted(count, 'result')} would change:" if count else "No result would change."
        yield "", f"Nothing was entered. {found}", "bold"
        yield from (("would change", change.line(), "") for change in report.would_change)
    yield from (("", words, "") for words in _legend(report.rows))
    for refused in (one for one in report.refused if with_waiting or not one.waits):
        yield "waits" if refused.waits else "refused", f"{refused.path}: {refused.reason}", "yellow"
    yield from (("unreadable", f"{where}: {why}", "yellow") for where, why in _unreadable(report))
    for name, due in report.due.items():
        yield "due", f"{name} {due:%Y-%m-%d %H:%M}, time zone {due.tzinfo}", ""
    for key, words in remarks_on(report.rows).items():
        yield "remark", f"{'/'.join(key)}: {words}", ""
    yield from (("note", notice, "") for notice in report.notices)
    for why, count in report.run_again.items():
        yield "run again", f"{counted(count, 'notebook')}: {why}", ""
    yield from (("problem", problem, "red") for problem in report.problems)
    yield from (("unsafe", note, "red") for note in [report.note] if note)


@dataclass(frozen=True)
class _Column:
    """A column of the printed table, with a cell for each student."""

    heading: str
    cells: Sequence[Text]
    options: Mapping[str, Any] = field(default_factory=lambda: {"no_wrap": True})

    @property
    def widest(self) -> Self:
        """The column with its widest cell alone, which is as wide: rich is slow at measuring many cells."""
        widest = max(self.cells, key=lambda cell: max(map(cell_len, cell.plain.split("\n"))))
        return replace(self, cells=[widest])


def tables(rows: Sequence[Row], console: Console) -> Iterator[Table]:
    """Yield tables with a row per student and a column per exercise.

    A table that is too wide is divided into several tables. The last one also has late penalty, dropped work and total.

    Args:
        rows: The rows to show.
        console: The console into which each table has to fit.
    """
    results = {(row.student, row.assignment, row.exercise): row for row in rows}
    students = grouped(rows, lambda row: row.student)
    first = _Column("student", [_name(own[0]) for own in students.values()], _FOLDED)
    # With headings of two lines, four exercises fit into a terminal of 80 characters.
    left = [
        _Column(name.replace(".", "\n."), [_cell(results.get((student, *key))) for student in students])
        for key, name in columns(rows).items()
    ]
    last = list(_last_columns(rows, list(students.values())))

    def columns_of(count: int) -> list[_Column]:
        return [first, *left[:count], *(last if count == len(left) else [])]

    while left:
        here = next((count for count in range(len(left), 1, -1) if _fits(columns_of(count), console)), 1)
        yield _table(columns_of(here))
        left = left[here:]


def _last_columns(rows: Sequence[Row], students: Sequence[Sequence[Row]]) -> Iterator[_Column]:
    there = {row.exercise for row in rows}
    if LATE in there:
        points = [sum(row.score for row in own if row.exercise == LATE) for own in students]
        yield _Column("late", [Text(f"{one:g}" if one else "", style="red") for one in points], _RIGHT)
    if DROPPED in there:
        names = [[row.assignment for row in own if row.exercise == DROPPED] for own in students]
        yield _Column("dropped", [Text("\n".join(one), style="dim") for one in names], _FOLDED)
    totals = [(total(own), sum(row.max_score for row in own)) for own in students]
    cells = [Text("–" if score is None else f"{score:g}/{most:g}") for score, most in totals]
    yield _Column("total", cells, _RIGHT)


def _fits(shown: Sequence[_Column], console: Console) -> bool:
    """Return True if no cell of a table with these columns is cut off or wrapped."""
    narrow = _table([one.widest for one in shown])
    return console.measure(narrow, options=console.options.update(width=_ANY_WIDTH)).maximum <= console.width


def _table(of: Sequence[_Column]) -> Table:
    shown = Table(header_style="bold", box=box.SIMPLE_HEAD, pad_edge=False)
    for one in of:
        shown.add_column(one.heading, **one.options)
    for cells in zip(*(one.cells for one in of), strict=True):
        shown.add_row(*cells)
    return shown


def _name(row: Row) -> Text:
    return Text(f"{row.student}\n{printable(row.name)}" if row.name else row.student)


def _cell(row: Row | None) -> Text:
    if row is None or row.state in (NOT_SUBMITTED, EXCUSED):
        return Text("–" if row is None or row.state == NOT_SUBMITTED else "excused", style="dim")
    return Text(f"{row.score:g}/{row.max_score:g}{row.mark}", style=_STYLES.get(row.state, "yellow"))


def _diagnoses(rows: Sequence[Row]) -> Table:
    """Return a table of the recognized mistakes: a line for each student and exercise."""
    names = columns(rows)
    shown = Table.grid(padding=(0, 2))
    for row in rows:
        if row.diagnosis:
            shown.add_row(Text(row.student), names[row.assignment, row.exercise], row.diagnosis)
    return shown


def _unreadable(report: GradeReport) -> list[tuple[str, str]]:
    """Return pairs of a submission and the reason why its notebook cannot be read, without refused files."""
    refused = {(entry.path.parent.parent.name, entry.path.parent.name) for entry in report.refused}
    reasons = {
        f"{row.student}/{row.assignment}": row.reason
        for row in report.rows
        if row.diagnosis == UNREADABLE and (row.student, row.assignment) not in refused
    }
    return list(reasons.items())


def _legend(rows: Sequence[Row]) -> list[str]:
    """Return a line about each mark that appears after points in the table."""
    waiting = sum(row.waits for row in rows)
    marks = {row.mark for row in rows}
    found = ["*  a person gave these points, or a part of them"] if "*" in marks else []
    if waiting:
        found.append(f"?  waits for a person ({waiting} in all): give the points in formgrader")
    return found


def _near(path: Path) -> Path:
    """Return a path relative to the current folder; if it is outside of this folder, the path unchanged."""
    here = path.cwd()
    return path.relative_to(here) if path.is_relative_to(here) else path
