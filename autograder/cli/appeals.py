"""The commands for an appeal: list a student's results, save one check with its evidence, and judge it again."""

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
"""The maximum length of a printed line, in characters. Lines about ordinary appeals have at most half as many."""
_MAX_LINES = 100
"""The maximum number of differences to print, and also of notes. A damaged file could cause any number of them."""


def _fail(message: str) -> NoReturn:
    """End the command with a message that may quote text from a student's file."""
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

    The file contains the student's code, the expected output, the judge's evidence and verdict, and the course's
    version, as readable JSON. The command `replay` judges the check again from this file.
    """
    from autograder.grading.appeal import write_appeal

    with grading_errors():
        click.echo(write_appeal(folder, student, exercise, output))


def _shown(line: str) -> str:
    """Return a line that is safe to print: shortened, and without characters that control a terminal."""
    return printable(line if len(line) <= _MAX_COLUMNS else f"{line[:_MAX_COLUMNS]}…")


@click.command()
@click.argument("file", type=click.Path(path_type=Path))
@click.option(
    "--mcap",
    type=click.Path(path_type=Path),
    help="Also write the messages that the judge saw into this file, for Foxglove and other programs that open MCAP.",
)
@click.option(
    "--bag",
    type=click.Path(path_type=Path),
    help="Also write the messages of topics into this file, for ros2 bag play.",
)
@as_json_option
def replay(file: Path, mcap: Path | None, bag: Path | None, as_json: bool) -> None:
    """Judge the check in an appeal FILE again, from its evidence and with the present version of the course.

    This runs no code of the student, and starts no ROS node.

    The file itself proves nothing, because any person can write such a file. For proof, have `appeal` write the file
    from the class.

    Exit code 0: the verdict is the same; 1: the verdict differs; 2: the check cannot be judged again.
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
    except Exception as error:  # a damaged file may cause any kind of error
        _fail(
            f"{file} is not a valid appeal file ({type(error).__name__}: {error}). The file was edited, or comes from "
            "a different version of the course: use the version that wrote it."
        )
    if as_json:
        print_json({"student": appeal.student, "course": appeal.course, "replay": again})
    else:
        for line in lines:
            click.echo(_shown(line))
    sys.exit(1 if again.differences else 0)


def check_name(path: Path) -> None:
    """End the command with exit code 2 if the name of a file for messages does not end in .mcap."""
    if path.suffix != ".mcap":
        _fail(f"the name of a file for messages must end in .mcap, such as check.mcap; {path.name} does not")


def save_messages(seen: Kept, path: Path) -> str:
    """Write the messages of a check as MCAP, and return a line about the file. On failure, end with exit code 2."""
    from autograder.appeals.messages_seen import write_messages

    try:
        with path.open("wb") as stream:
            count = write_messages(seen, stream)
    except OSError as error:
        _fail(f"{path} cannot be written: {error.strerror}")
    return f"{path}: {count} events, as JSON"


def save_bag(seen: Kept, path: Path) -> str:
    """Write the messages of topics for ``ros2 bag play``. Return and fail in the same way as ``save_messages``."""
    from autograder.appeals.messages_seen import write_bag

    try:
        with path.open("wb") as stream:
            written, left_out = write_bag(seen, stream)
    except OSError as error:
        _fail(f"{path} cannot be written: {error.strerror}")
    missing = (
        f" ({left_out} more were left out, because their type is not installed here)" if left_out else ""
    )
    return f"{path}: {written} messages of topics{missing}"


def _lines(appeal: Appeal, again: Replay) -> Iterator[str]:
    """Yield the result of a replay as lines."""
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
    yield f"note: any person can write such a file; for proof, have `{COMMAND} appeal` write it from the class"


def _told(verdict: Verdict) -> str:
    diagnosis = f", {verdict.diagnosis.key}" if verdict.diagnosis else ""
    return f"{verdict.state}, {verdict.score:g} of {verdict.max_score:g} points{diagnosis}"


COMMANDS = (
    attempts,
    appeal,
    replay,
)
