"""The commands for instructors about graded work: report, export to the LMS, attempts, appeals.

For an appeal, an instructor lists a student's results, saves one check with its evidence, and judges the check again.
"""

from __future__ import annotations

import sys
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from autograder.cli.class_options import (
    class_command,
    class_folder,
    into_columns,
    only_assignments,
    only_sections,
    over_option,
)
from autograder.cli.command_results import as_json_option, fail, grading_errors, print_json, print_line
from autograder.command_name import COMMAND

if TYPE_CHECKING:
    from collections.abc import Iterator

    from autograder.appeals.appeal_file import Appeal
    from autograder.appeals.replaying import Replay
    from autograder.verdict import Verdict


@class_command()
@class_folder
@click.option(
    "--to",
    type=click.Choice(["canvas", "moodle", "blackboard", "brightspace", "sakai", "ilias", "csv"]),
    callback=lambda _context, _option, chosen: chosen or "",
    help="The LMS that will import the files. With --into, it is the one from which the list comes.",
)
@only_assignments
@only_sections
@click.option(
    "--into",
    type=click.Path(path_type=Path),
    help="Fill in this list, which was exported from the LMS.",
)
@into_columns
@over_option
@click.option(
    "--absent",
    type=click.Choice(["blank", "zero"]),
    default="blank",
    help="The value for students without a submission. The default is an empty cell.",
)
@click.option(
    "--output",
    type=click.Path(path_type=Path),
    help="The folder to write the files to. The default is FOLDER/export.",
)
@click.option("--dry-run", is_flag=True, help="Write nothing, and show what would change in the list.")
@as_json_option
def export(folder: Path, to: str, absent: str, output: Path | None, as_json: bool, **choices: Any) -> None:
    """Write the points and the feedback (as a zip) in the format that an LMS imports.

    Exit code 2: the instructor has to decide something, and the printed lines say what to type.
    """
    from autograder.grading.reporting.export_files import ExportChoices
    from autograder.grading.reporting.export_files import export as write_files

    if not to and not choices["into"]:
        fail("say for which system: --to canvas, or have a list of the system filled in: --into LIST")
    with grading_errors():
        done = write_files(folder, to, ExportChoices(folder=output, absent_zero=absent == "zero", **choices))
    if as_json:
        files = [{"path": str(file), "purpose": purpose} for file, purpose in done.files]
        print_json(
            {
                "files": files,
                "notices": (*done.ungraded, *done.notices),
                "changes": done.changes,
                "questions": done.questions,
            }
        )
    else:
        for line in done.lines():
            print_line(line)
    sys.exit(done.exit_code)


@class_command()
@class_folder
@only_sections
@click.option(
    "--without-names",
    is_flag=True,
    help="Show numbers instead of students' names, and no links to their pages.",
)
@click.option(
    "--output", type=click.Path(path_type=Path), help="The page to write. The default is FOLDER/report.html."
)
@as_json_option
def report(
    folder: Path, sections: tuple[str, ...], without_names: bool, output: Path | None, as_json: bool
) -> None:
    """Write a page about the class FOLDER: points, mistakes, exercises and each student's progress."""
    from autograder.grading.classes.class_directory import ClassDirectory
    from autograder.grading.reporting.class_table import read_table
    from autograder.grading.reporting.grade_report import table_json
    from autograder.grading.reporting.report_page import write_report

    if as_json and without_names:
        fail(
            "--json shows the ids of students, so it cannot be combined with --without-names: leave out one of the two."
        )
    with grading_errors():
        page = write_report(folder, names=not without_names, to=output, sections=sections)
        if as_json:
            print_json(table_json(page, read_table(ClassDirectory(folder), sections)))
        else:
            print_line(str(page))


@class_command()
@class_folder
@click.argument("student")
@as_json_option
def attempts(folder: Path, student: str, as_json: bool) -> None:
    """List the results of each time that STUDENT was graded in the class FOLDER."""
    from autograder.grading.class_store import ClassStore
    from autograder.grading.classes.class_directory import ClassDirectory

    with grading_errors(), ClassStore(ClassDirectory(folder)) as store:
        found = store.attempts(student)
    if not found:
        fail(f"No student with the id {student!r} was graded in this class.")
    if as_json:
        print_json({"student": student, "attempts": found})
        return
    for attempt in found:
        print_line(attempt.line())


@class_command()
@class_folder
@click.argument("student")
@click.argument("exercise")
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    help="The file to write. The default is FOLDER/appeals/STUDENT-EXERCISE.zip.",
)
def appeal(folder: Path, student: str, exercise: str, output: Path | None) -> None:
    """Save everything about the check of EXERCISE by STUDENT in the class FOLDER.

    The file is a zip with the student's code and page, the expected output, the judge's evidence and verdict, and the
    course's version. The command `replay` judges the check again from this file.
    """
    from autograder.grading.reporting.appeal_writing import write_appeal

    with grading_errors():
        print_line(str(write_appeal(folder, student, exercise, output)))


@click.command()
@click.argument("file", type=click.Path(path_type=Path))
@as_json_option
def replay(file: Path, as_json: bool) -> None:
    """Judge the check in an appeal FILE again, from its evidence and with the present version of the course.

    This runs no code of the student, and starts no ROS node.

    The file itself proves nothing, because any person can write such a file. For proof, have `appeal` write the file
    from the class.

    Exit code 0: the verdict is the same; 1: the verdict differs; 2: the check cannot be judged again.
    """
    from autograder.appeals import appeal_file, replaying

    try:
        appeal = appeal_file.read(file)
        again = replaying.replay(appeal.seen)
        lines = list(_lines_of_replay(appeal, again))
    except (appeal_file.BadAppeal, replaying.CannotReplay) as error:
        fail(_cut(str(error)))
    except Exception as error:  # a damaged file may cause any kind of error
        fail(
            f"{file} is not a valid appeal file ({type(error).__name__}: {_cut(str(error))}). The file was edited, or "
            "comes from a different version of the course: use the version that wrote it."
        )
    if as_json:
        print_json({"student": appeal.check.student, "course": appeal.check.course, "replay": again})
    else:
        for line in lines:
            print_line(_cut(line))
    sys.exit(1 if again.differences else 0)


def _lines_of_replay(appeal: Appeal, again: Replay) -> Iterator[str]:
    """Yield the result of a replay as lines."""
    then = again.then
    checked = f"{datetime.fromtimestamp(appeal.seen.at, tz=UTC):%Y-%m-%d %H:%M:%S} UTC"
    check = appeal.check
    yield f"{then.exercise} by {check.student}, checked {checked} with course {check.course[:8]}"
    yield f"then: {_verdict_in_words(then)}"
    yield f"now:  {_verdict_in_words(again.now)}"
    if again.differences:
        yield "a different verdict:"
        yield from (f"  {line}" for line in again.differences[:_MAX_LINES])
    else:
        yield "the same verdict, points and diagnosis"
    yield from (f"note: {note}" for note in again.notes[:_MAX_LINES])
    yield f"note: any person can write such a file; for proof, have `{COMMAND} appeal` write it from the class"


def _verdict_in_words(verdict: Verdict) -> str:
    diagnosis = f", {verdict.diagnosis.key}" if verdict.diagnosis else ""
    return f"{verdict.state}, {verdict.score:g} of {verdict.max_score:g} points{diagnosis}"


_MAX_COLUMNS = 4_000
"""The maximum length of a printed line, in characters. Lines about ordinary appeals have at most half as many."""
_MAX_LINES = 100
"""The maximum number of differences to print, and also of notes. A damaged file could cause any number of them."""


def _cut(line: str) -> str:
    return line if len(line) <= _MAX_COLUMNS else f"{line[:_MAX_COLUMNS]}…"


RESULT_COMMANDS = (report, export, attempts, appeal, replay)
