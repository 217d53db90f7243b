"""The command ``week``: collects a download, grades it, and exports the points.

The headers of the files say what they are: a list into which points go, a list of students, a list with times, or else
a download. What the instructor has to decide comes last, each with the line to type.
"""

from __future__ import annotations

import contextlib
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

from autograder import standard_output
from autograder.grading.batch import grade
from autograder.grading.collecting.collect import collect, report_lines
from autograder.grading.collecting.downloaded_files import read_list
from autograder.grading.collecting.list_times import NO_LIST
from autograder.grading.collecting.systems import EACH
from autograder.grading.grading_errors import GradingError, course_command
from autograder.grading.new_classes.changing_students import change_students
from autograder.grading.rebuilding.submitted_notebook import read_bytes
from autograder.grading.reporting.export_files import ExportChoices, export
from autograder.grading.reporting.grade_report import show
from autograder.grading.reporting.gradebook_layouts import LAYOUTS
from autograder.grading.reporting.lms_list_filling import read_lms_list
from autograder.grading.running.batch_progress import plain_line
from autograder.grading.table.roster import NAME as ROSTER
from autograder.grading.table.students_csv import read_students_csv

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from pathlib import Path

    from autograder.grading.collecting.collect import CollectReport
    from autograder.grading.reporting.export_files import Exported
    from autograder.grading.reporting.grade_report import GradeReport


@dataclass(frozen=True)
class WeekChoices:
    """The choices of the instructor.

    Attributes:
        collecting: The options of ``collect``, by name.
        columns: The columns of assignments in the list, if their names do not show it.
        over: True to replace what people typed into the LMS.
    """

    collecting: Mapping[str, Any] = field(default_factory=dict)
    columns: Mapping[str, str] = field(default_factory=dict)
    over: bool = False


@dataclass(frozen=True)
class WeekReport:
    """The result of a week.

    Attributes:
        collected: The result of collecting.
        graded: The result of grading.
        exported: The result of the export; None if the files do not show to which system the points go.
        students: Lines about the list of students.
        questions: What the instructor has to decide about the students.
    """

    collected: CollectReport
    graded: GradeReport
    exported: Exported | None
    students: tuple[str, ...] = ()
    questions: tuple[str, ...] = ()

    @property
    def exit_code(self) -> int:
        """2 if something waits for the instructor, or could not be done; otherwise 0."""
        parts = (self.collected, self.graded, self.exported)
        return 2 if self.questions or any(one.exit_code for one in parts if one) else 0


@dataclass(frozen=True)
class _Files:
    """The files of a week, by what they are.

    Attributes:
        into: The list into which points go; None if there is none.
        students: The list of students; None if there is none.
        downloads: The files to collect.
    """

    into: Path | None
    students: Path | None
    downloads: tuple[Path, ...]


def _sorted_out(files: Sequence[Path]) -> _Files:
    """Tell what each file is, by the names of its columns.

    Raises:
        GradingError: A file does not exist, or two lists take points.
    """
    into: list[Path] = []
    students: list[Path] = []
    downloads: list[Path] = []
    for file in files:
        if not file.exists():
            raise GradingError(f"There is no {file}.")
        if file.suffix.lower() != ".csv":
            downloads.append(file)
            continue
        form, has_students = None, False
        with contextlib.suppress(GradingError):
            form = read_lms_list(file).form
        is_gradebook = form is not None and form.points == EACH
        if form is None or is_gradebook:
            with contextlib.suppress(GradingError):
                has_students = bool(read_students_csv(file).students)
        into += [file] if form else []
        students += [file] if has_students else []
        if not has_students and not is_gradebook:
            if read_list(file.name, read_bytes(file)) is None:
                raise GradingError(f"{file}: {NO_LIST}.")
            downloads.append(file)
    if len(into) > 1 or len(students) > 1:
        names = ", ".join(map(str, into if len(into) > 1 else students))
        raise GradingError(f"{names}: name one list for the points, and one list of students.")
    return _Files(into[0] if into else None, students[0] if students else None, tuple(downloads))


def week(path: Path, files: Sequence[Path], choices: WeekChoices = WeekChoices()) -> WeekReport:
    """Collect a download, grade it, and export the points.

    Args:
        path: The class directory.
        files: The download, and lists of an LMS.
        choices: The choices of the instructor.

    Raises:
        GradingError: One of the steps cannot be done. What the steps before it did is done.
    """
    sorted_out = _sorted_out(files)
    lines, questions = _take_students(path, sorted_out.students)
    collected = collect(path, sorted_out.downloads, **choices.collecting)
    graded = grade(path)
    exported = _exported(path, sorted_out.into, collected, choices)
    return WeekReport(collected, graded, exported, tuple(lines), tuple(questions))


def _take_students(path: Path, new: Path | None) -> tuple[list[str], list[str]]:
    """Use a list of students if the class has none; otherwise, return a question about what it would change."""
    if new is None:
        return [], []
    if not (path / ROSTER).exists():
        return change_students(path, new, {}, is_final=True)[:-1], []
    lines = change_students(path, new, {}, is_final=False)
    words = [line.split()[0] for line in lines[:-2]]
    if not words:
        return [], []
    counts = ", ".join(f"{word} {words.count(word)}" for word in dict.fromkeys(words))
    to_do = course_command("students", path, new)
    return [], [f"{new.name} changes the students of the class ({counts}): type {to_do}"]


def _exported(
    path: Path, into: Path | None, collected: CollectReport, choices: WeekChoices
) -> Exported | None:
    """Export into the list, or for the only system from which the download came; None if neither is known."""
    systems = [name for name in collected.systems if name in LAYOUTS]
    if into is None and len(systems) != 1:
        return None
    options = ExportChoices(collected.assignments, into, columns=choices.columns, over=choices.over)
    done = export(path, "" if into else systems[0], options)
    return replace(done, ungraded=())


def show_week(report: WeekReport) -> None:
    """Print the result of a week. What waits for the instructor comes last."""
    console = standard_output.console()
    show(report.graded, console, with_waiting=False)
    for text in _lines(report):
        plain_line(console, text, "yellow" if text.startswith("waits") else "")


def _lines(report: WeekReport) -> Iterator[str]:
    yield from report.students
    yield from report_lines(report.collected, with_waiting=False)
    if report.exported:
        yield from replace(report.exported, questions=()).lines()
    else:
        yield "note         no points were exported: name the list of your LMS as well, or use export --to SYSTEM"
    to_do = course_command("collect", report.collected.path)
    for one in (one for one in report.graded.refused if one.waits):
        yield f"waits        {one.path}: {one.reason}, then type {to_do}"
    for question in (*(report.exported.questions if report.exported else ()), *report.questions):
        yield f"waits        {question}"
