"""The commands about one student's checks: list them, save one, judge it again, and save its messages."""

from __future__ import annotations

import sys
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

import click

from autograder.cards.readable import printable
from autograder.cli.instructors import class_folder
from autograder.cli.results import as_json_option, fail, grading_errors, print_json
from environment.installation import COMMAND

if TYPE_CHECKING:
    from collections.abc import Iterator

    from autograder.appeals.appeal_file import Appeal
    from autograder.appeals.replaying import Replay
    from autograder.judge.verdicts.keeping import Kept
    from autograder.verdict import Verdict

_MAX_COLUMNS = 4_000
"""The maximum length of a printed line, in characters. The longest usual line, with an expected and a seen text in
full, has half of that.
"""
_MAX_LINES = 100
"""The maximum number of printed differences, and of printed notes. No exercise has a third as many criteria."""


def _fail(message: str) -> NoReturn:
    """End the command with a message that may contain text written by another person."""
    fail(_shown(message))


@click.command()
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
        click.echo(printable(attempt.line()))


@click.command()
@class_folder
@click.argument("student")
@click.argument("exercise")
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    help="The file to write. The default is FOLDER/appeals/STUDENT-EXERCISE.json.",
)
def appeal(folder: Path, student: str, exercise: str, output: Path | None) -> None:
    """Save everything about the check of EXERCISE by STUDENT in the class FOLDER.

    The student's code, the expected output, the judge's evidence and verdict, and the course's version. The file is
    JSON to read, and `replay` judges it again.
    """
    from autograder.grading.appeal import write_appeal

    with grading_errors():
        click.echo(write_appeal(folder, student, exercise, output))


def _shown(line: str) -> str:
    """Return a line in a form that is safe to print, because the file may contain any text of any length."""
    return printable(line if len(line) <= _MAX_COLUMNS else f"{line[:_MAX_COLUMNS]}…")


@click.command()
@click.argument("file", type=click.Path(path_type=Path))
@click.option(
    "--mcap",
    type=click.Path(path_type=Path),
    help="Also write the messages that the judge saw, for Foxglove and other programs that open MCAP.",
)
@click.option(
    "--bag", type=click.Path(path_type=Path), help="Also write the messages of topics, for ros2 bag play."
)
@as_json_option
def replay(file: Path, mcap: Path | None, bag: Path | None, as_json: bool) -> None:
    """Judge the check in an appeal FILE again, from what was seen then and with the course as it is now.

    No code of the student is run, and no ROS node is started.

    A file proves nothing by itself, because any person can write one. Have `appeal` write it from the class.

    Exit code 0: the same verdict; 1: a different one; 2: it cannot be judged again.
    """
    from autograder.appeals import appeal_file, replaying

    try:
        for path in (mcap, bag):
            if path is not None:
                check_name(path)
        appeal = appeal_file.read(file)
        if mcap is not None:
            click.echo(save_messages(appeal.seen, mcap), err=as_json)
        if bag is not None:
            click.echo(save_bag(appeal.seen, bag), err=as_json)
        again = replaying.replay(appeal.seen)
        lines = list(_lines(appeal, again))
    except (appeal_file.BadAppeal, replaying.CannotReplay) as error:
        _fail(str(error))
    except Exception as error:  # the file may contain anything, so anything may be raised
        _fail(
            f"{file} is not a valid appeal file ({type(error).__name__}: {error}). It was edited, or comes from "
            "a different version of the course: use that version."
        )
    if as_json:
        print_json({"student": appeal.student, "course": appeal.course, "replay": again})
    else:
        for line in lines:
            click.echo(_shown(line))
    sys.exit(1 if again.differences else 0)


def check_name(path: Path) -> None:
    """End with exit code 2 if the name of a file for messages does not end in .mcap."""
    if path.suffix != ".mcap":
        _fail(f"the name of a file for messages must end in .mcap, such as check.mcap; {path.name} does not")


def save_messages(seen: Kept, path: Path) -> str:
    """Write the messages of a check as MCAP, and return a line about the file. If that fails, end with exit code 2."""
    from autograder.appeals.messages_seen import write_messages

    try:
        with path.open("wb") as stream:
            count = write_messages(seen, stream)
    except OSError as error:
        _fail(f"{path} cannot be written: {error.strerror}")
    return f"{path}: {count} events, as JSON"


def save_bag(seen: Kept, path: Path) -> str:
    """Write the messages of topics for ``ros2 bag play``, and return a line about the file.

    If that fails, end with exit code 2.
    """
    from autograder.appeals.messages_seen import write_bag

    try:
        with path.open("wb") as stream:
            written, left_out = write_bag(seen, stream)
    except OSError as error:
        _fail(f"{path} cannot be written: {error.strerror}")
    missing = f" ({left_out} more have a type that is not known here)" if left_out else ""
    return f"{path}: {written} messages of topics{missing}"


def _lines(appeal: Appeal, again: Replay) -> Iterator[str]:
    """Yield the result of a replay as lines. The first is the answer."""
    then = again.then
    at = datetime.fromtimestamp(appeal.seen.at, tz=UTC)
    yield f"{then.exercise} by {appeal.student}, checked {at:%Y-%m-%d %H:%M:%S} UTC with course {appeal.course[:8]}"
    yield f"then: {_told(then)}"
    yield f"now:  {_told(again.now)}"
    if again.differences:
        yield "a different verdict:"
        yield from (f"  {line}" for line in again.differences[:_MAX_LINES])
    else:
        yield "the same verdict, points and diagnosis"
    yield from (f"note: {note}" for note in again.notes[:_MAX_LINES])
    yield f"note: a file proves nothing, any person can write one; `{COMMAND} appeal` writes it from the class"


def _told(verdict: Verdict) -> str:
    diagnosis = f", {verdict.diagnosis.key}" if verdict.diagnosis else ""
    return f"{verdict.state}, {verdict.score:g} of {verdict.max_score:g} points{diagnosis}"


COMMANDS = (
    attempts,
    appeal,
    replay,
)
