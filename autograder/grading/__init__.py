"""Grading a class: an nbgrader course directory whose notebooks are judged on the wire.

The commands come in here. Imports are inside the functions: nbgrader alone takes more than a second.
"""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

# jsonschema, which nbformat and nbgrader import, loads a grammar of internationalised addresses where it finds one:
# a second at every start, for a check that no notebook asks for. It does without where the import fails.
sys.modules.setdefault("rfc3987_syntax", None)  # type: ignore[arg-type]

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from rich.console import Console

    from autograder.grading.classes.new_class import NewClass
    from autograder.grading.collecting.collect import CollectReport
    from autograder.grading.reporting.report import GradeReport
    from autograder.grading.similarity.finding import Similar


def new_class(path: Path, course_root: Path, *, assignments: Sequence[str] = ()) -> NewClass:
    """Make a class directory; see :func:`autograder.grading.classes.new_class.new_class`.

    Raises:
        GradingError: It cannot be made; the message says what to do.
    """
    from autograder.grading.classes.new_class import new_class as make

    return make(path, course_root, assignments=assignments)


def renew_class(path: Path, course_root: Path, *, assignments: Sequence[str] = ()) -> list[str]:
    """Bring a class's sources up to date; see :func:`autograder.grading.following.renewing.renew`.

    Raises:
        GradingError: They cannot be brought up to date; the message says what to do.
    """
    from autograder.grading.following.renewing import renew

    return renew(path, course_root, assignments)


def grade(
    path: Path,
    *,
    assignments: Sequence[str] = (),
    students: Sequence[str] = (),
    again: bool = False,
    jobs: int | None = None,
    unsafe_no_sandbox: bool = False,
    scheduler: str | None = None,
    dry_run: bool = False,
    as_json: bool = False,
    console: Console | None = None,
) -> GradeReport:
    """Grade a class and print what came of it; see :func:`autograder.grading.batch.grade`.

    Args:
        path: The class directory.
        assignments: Only these; all by default.
        students: Only these; all by default.
        again: Execute everything anew, also what is unchanged.
        jobs: Notebooks executed at once; as many as processors and memory allow by default.
        unsafe_no_sandbox: Run submissions with all rights of whatever process executes them.
        scheduler: The address of a Dask scheduler whose workers execute the notebooks; this machine by default.
        dry_run: Enter nothing, and say who would get other points.
        as_json: Print one JSON object instead of the table.
        console: Where the result is printed; standard output by default. Progress goes to standard error.

    Raises:
        GradingError: The class cannot be graded; the message says what to do.
    """
    from autograder.grading.batch import grade as grade_class
    from autograder.grading.running import sandboxing

    if unsafe_no_sandbox:
        sandboxing.switch_off(path)
    report = grade_class(
        path,
        assignments=assignments,
        students=students,
        again=again,
        jobs=jobs,
        scheduler=scheduler,
        dry_run=dry_run,
    )
    if as_json:
        from autograder.grading.reporting.report_json import report_json

        sys.stdout.write(f"{report_json(report).decode()}\n")
    else:
        from autograder.grading.reporting.report_table import show

        show(report, console)
    return report


def collect(
    path: Path,
    sources: Sequence[Path],
    *,
    assignment: str = "",
    timezone: str = "",
    form: str = "",
    console: Console | None = None,
) -> CollectReport:
    """Put what was downloaded from an LMS into a class and print what came of it.

    Args:
        path: The class directory.
        sources: Zips, folders, notebooks, and lists that say who a number is.
        assignment: What all of it is for; told from names and contents by default.
        timezone: Of times in names and lists, such as ``Europe/Berlin``; this machine's by default.
        form: Which LMS it is from; told from the names by default.
        console: Where the result is printed; standard output by default.

    Raises:
        GradingError: It cannot be collected; the message says what to do.
    """
    from zoneinfo import ZoneInfo

    from autograder.grading.collecting.collect import collect as collect_files
    from autograder.grading.collecting.showing import show
    from autograder.grading.errors import GradingError

    try:
        zone = ZoneInfo(timezone) if timezone else None
    except (ValueError, OSError, LookupError) as error:
        raise GradingError(f"There is no time zone {timezone!r}. A name looks like Europe/Berlin.") from error
    report = collect_files(path, sources, assignment=assignment, zone=zone, form=form)
    show(report, console)
    return report


def export_points(
    path: Path,
    to: str,
    *,
    assignments: Sequence[str] = (),
    into: Path | None = None,
    folder: Path | None = None,
    console: Console | None = None,
) -> None:
    """Write points and feedback in the form of an LMS and print which files there are.

    Args:
        path: The class directory.
        to: ``canvas``, ``moodle``, ``csv`` or ``xlsx``.
        assignments: Only these; all that somebody has handed in by default.
        into: A list that the LMS has exported, to be filled in.
        folder: Where to write; ``export`` in the class by default.
        console: Where the result is printed; standard output by default.

    Raises:
        GradingError: It cannot be exported; the message says what to do.
    """
    from rich.console import Console

    from autograder.grading.exporting.export import export as write_files

    done = write_files(path, to, assignments=assignments, into=into, folder=folder)
    console = console or Console()
    lines = [f"{file}\n    {purpose}" for file, purpose in done.files]
    for line in (*lines, *(f"note: {notice}" for notice in done.notices)):
        console.print(line, markup=False, highlight=False, soft_wrap=True)


def write_report(path: Path, *, names: bool = True, to: Path | None = None) -> Path:
    """Write the page about a class; see :func:`autograder.grading.overview.page.write_report`.

    Raises:
        GradingError: It cannot be written; the message says what to do.
    """
    from autograder.grading.overview.page import write_report as write

    return write(path, names=names, to=to)


def similar(
    path: Path, assignment: str = "", *, to: Path | None = None, console: Console | None = None
) -> Similar:
    """Print the pairs of submissions that are closer than the task explains, and write the page that shows them.

    Args:
        path: The class directory.
        assignment: Only this one; all by default.
        to: Where to write the page; ``similar.html`` in the class by default.
        console: Where the result is printed; standard output by default.

    Raises:
        GradingError: Nothing was handed in, or the class cannot be read; the message says what to do.
    """
    from autograder.grading.classes.class_directory import ClassDirectory
    from autograder.grading.entering.journal import write_whole
    from autograder.grading.errors import clear_disk_errors
    from autograder.grading.similarity.finding import find_similar
    from autograder.grading.similarity.page import NAME, page
    from autograder.grading.similarity.showing import show

    directory = ClassDirectory(path)
    to = (to or directory.path / NAME).absolute()
    with clear_disk_errors(directory.path):
        found = find_similar(directory, assignment)
        write_whole(to, page(found).encode())
    show(found, to, console)
    return found


def compare(path: Path, before: str = "", after: str = "") -> list[str]:
    """What changed between two runs of a class, a line for each result.

    Args:
        path: The class directory.
        before: A run; the last but one by default.
        after: A later run; the last one by default.

    Raises:
        GradingError: There are not two runs, or none of that name.
    """
    from autograder.cards.readable import printable
    from autograder.grading.classes.class_directory import ClassDirectory
    from autograder.grading.table.differences import compare as compare_runs

    old, new, found = compare_runs(ClassDirectory(path).state, before, after)
    return [f"{old} → {new}: {len(found)} results differ", *(printable(one.line()) for one in found)]


def attempts_of(path: Path, student: str) -> list[str]:
    """Each time that a student was graded, a line each.

    Raises:
        GradingError: It is no class, or nobody of that id was graded in it.
    """
    from autograder.cards.readable import printable
    from autograder.grading.entering.attempts import read

    return [printable(attempt.line()) for attempt in read(path, student)]


def appeal(path: Path, student: str, exercise_id: str, *, to: Path | None = None) -> Path:
    """Write the appeal file of a check; see :func:`autograder.grading.appealing.appeal.write_appeal`.

    Raises:
        GradingError: There is nothing of that check; the message says what to do.
    """
    from autograder.grading.appealing.appeal import write_appeal

    return write_appeal(path, student, exercise_id, to)


def demo(path: Path, *, console: Console | None = None) -> GradeReport:
    """Make the sample class where it is not there yet, grade it and print the result.

    Where no sandbox is possible it is graded without one, and says so: the samples are the course's own.

    Raises:
        GradingError: It cannot be made or graded; the message says what to do.
    """
    from autograder.boxes.sandbox import why_impossible
    from autograder.grading.classes.sample_class import demo as show_sample
    from autograder.grading.running import sandboxing

    if why_impossible():
        sandboxing.switch_off(path)
    return show_sample(path, console=console)
