"""Differences of points: between two runs, or between the gradebook and what a run would enter."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import UTC, datetime
from typing import TYPE_CHECKING

import msgspec

from autograder.grading.errors import GradingError
from autograder.grading.reporting.rows import Row  # noqa: TC001  (msgspec reads the annotations)
from autograder.regular_files import write_whole

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from pathlib import Path

_KEPT = 50
"""Runs whose tables are kept."""


@dataclass(frozen=True)
class Difference:
    """Other points, or another diagnosis for the same points.

    Attributes:
        student: The student's id.
        assignment: The assignment's name.
        exercise: The exercise's id, or ``late``.
        before: Points before; None where there were none.
        after: Points now; None where there are none any more.
        diagnosis_before: What was diagnosed before.
        diagnosis_after: What is now.
        note: What else is worth knowing.
    """

    student: str
    assignment: str
    exercise: str
    before: float | None
    after: float | None
    diagnosis_before: str = ""
    diagnosis_after: str = ""
    note: str = ""

    def line(self) -> str:
        """One line for a person."""
        points = " → ".join("–" if points is None else f"{points:g}" for points in (self.before, self.after))
        words = ""
        if self.diagnosis_before != self.diagnosis_after:
            words = f" ({self.diagnosis_before or 'no mistake'} → {self.diagnosis_after or 'no mistake'})"
        return f"{self.student}  {self.exercise}  {points}{words}{f', {self.note}' if self.note else ''}"


@dataclass(frozen=True)
class Run:
    """The table as it was after a run.

    Attributes:
        at: When, in UTC.
        course: Stands for the version of the course.
        rows: The table.
    """

    at: datetime
    course: str
    rows: tuple[Row, ...]


class Runs:
    """The tables of the last runs of a class.

    Args:
        state: The class's folder of the autograder's own files.
    """

    def __init__(self, state: Path) -> None:
        self._folder = state / "runs"

    def names(self) -> list[str]:
        """The runs, the oldest first; a name is a time in UTC."""
        return sorted(path.stem for path in self._folder.glob("*.json"))

    def get(self, name: str) -> Run:
        """A run.

        Raises:
            GradingError: There is none of that name.
        """
        try:
            return msgspec.json.decode((self._folder / f"{name}.json").read_bytes(), type=Run)
        except (OSError, msgspec.MsgspecError) as error:
            raise GradingError(
                f"There is no run {name}. There is: {', '.join(self.names()[-10:]) or 'none'}."
            ) from error

    def keep(self, course: str, rows: Sequence[Row]) -> None:
        """Keep a table if it is another one than the last; the oldest are dropped.

        Raises:
            OSError: It could not be written.
        """
        names = self.names()
        if names and self._is_last(names[-1], course, rows):
            return
        now = datetime.now(tz=UTC)
        run = Run(now, course, tuple(rows))
        write_whole(self._folder / f"{now:%Y-%m-%dT%H-%M-%S.%f}.json", msgspec.json.encode(run))
        for name in names[: max(0, len(names) + 1 - _KEPT)]:
            (self._folder / f"{name}.json").unlink(missing_ok=True)

    def _is_last(self, name: str, course: str, rows: Sequence[Row]) -> bool:
        try:
            last = self.get(name)
        except GradingError:
            return False
        return (last.course, last.rows) == (course, tuple(rows))


def differences(before: Iterable[Row], after: Iterable[Row]) -> list[Difference]:
    """The rows in which two tables differ, in the order of the students."""
    earlier = {(row.student, row.assignment, row.exercise): row for row in before}
    later = {(row.student, row.assignment, row.exercise): row for row in after}
    found = []
    for key in sorted({*earlier, *later}):
        old, new = earlier.get(key), later.get(key)
        difference = Difference(
            *key,
            old.score if old else None,
            new.score if new else None,
            old.diagnosis if old else "",
            new.diagnosis if new else "",
        )
        if (difference.before, difference.diagnosis_before) != (difference.after, difference.diagnosis_after):
            found.append(difference)
    return found


def compare(state: Path, before: str = "", after: str = "") -> tuple[str, str, list[Difference]]:
    """The changes between two runs.

    Args:
        state: The class's folder of the autograder's own files.
        before: A run; the last but one by default.
        after: A later run; the last one by default.

    Returns:
        The names of the two runs, and where they differ.

    Raises:
        GradingError: There are not two runs, or none of that name.
    """
    runs = Runs(state)
    names = runs.names()
    if len(names) < 2 and not (before and after):
        raise GradingError("There are no two runs with different tables to compare yet.")
    before, after = before or names[-2], after or names[-1]
    return before, after, differences(runs.get(before).rows, runs.get(after).rows)
