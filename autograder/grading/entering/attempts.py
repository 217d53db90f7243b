"""A log of all the times that a student was graded; the table has only the last one."""

from __future__ import annotations

import os
from datetime import UTC, datetime
from typing import TYPE_CHECKING

import msgspec

from autograder.grading.classes.class_directory import ClassDirectory
from autograder.grading.errors import GradingError
from autograder.grading.reporting.rows import Row  # noqa: TC001  (msgspec reads the annotations)

if TYPE_CHECKING:
    from pathlib import Path


class Attempt(msgspec.Struct, frozen=True):
    """One time that a submission was graded and entered.

    Attributes:
        at: When, in UTC.
        assignment: The assignment's name.
        work: Stands for what was handed in and all that it was graded with: equal for the same once more.
        course: Stands for the version of the course.
        rows: The judge's results.
    """

    at: datetime
    assignment: str
    work: str
    course: str
    rows: tuple[Row, ...]

    def line(self) -> str:
        """One line for a person."""
        score, most = sum(row.score for row in self.rows), sum(row.max_score for row in self.rows)
        words = [
            f"{row.exercise} {row.score:g}" + (f" ({row.diagnosis})" if row.diagnosis else "")
            for row in self.rows
        ]
        return (
            f"{self.at:%Y-%m-%d %H:%M:%S} UTC  {self.assignment}  {score:g}/{most:g}  {', '.join(words)}  "
            f"[work {self.work[:8]}, course {self.course[:8]}]"
        )


def note(directory: ClassDirectory, student: str, attempt: Attempt) -> None:
    """Add an attempt to a student's log.

    Raises:
        OSError: It could not be written.
    """
    path = _path(directory, student)
    path.parent.mkdir(exist_ok=True)
    with path.open("ab") as log:
        log.write(b"\n" + msgspec.json.encode(attempt) + b"\n")  # a line of its own also behind half a one
        log.flush()
        os.fsync(log.fileno())


def now() -> datetime:
    """The time, in UTC."""
    return datetime.now(tz=UTC)


def read(path: Path, student: str) -> list[Attempt]:
    """A student's attempts, the first one first; a line that a power cut left unfinished is left out.

    Args:
        path: The class directory.
        student: The student's id.

    Raises:
        GradingError: It is no class, or nobody of that id was ever graded in it.
    """
    file = _path(ClassDirectory(path), student)
    found = []
    try:
        lines = file.read_bytes().splitlines()
    except OSError as error:
        raise GradingError(
            f"Nobody of the id {student!r} was graded here since attempts are noted."
        ) from error
    for line in lines:
        try:
            found.append(msgspec.json.decode(line, type=Attempt))
        except msgspec.MsgspecError:
            continue
    return found


def _path(directory: ClassDirectory, student: str) -> Path:
    return directory.state / "attempts" / f"{student}.jsonl"
