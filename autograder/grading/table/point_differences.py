"""Finds the points that differ between two runs, or between the gradebook and a dry run."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from autograder.grading.errors import GradingError

if TYPE_CHECKING:
    from collections.abc import Iterable

    from autograder.grading.class_store import ClassStore
    from autograder.grading.reporting.rows import Row


@dataclass(frozen=True)
class Difference:
    """A change of a student's points or diagnosis in one exercise.

    Attributes:
        student: The student's id.
        assignment: The assignment's name.
        exercise: The exercise's id, or ``late``.
        before: The points before; None if there were none.
        after: The points after; None if there are none.
        diagnosis_before: The diagnosis before.
        diagnosis_after: The diagnosis now.
        note: A remark for the instructor; empty if there is none.
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
        """Return the difference as a line of text."""
        points = " → ".join("–" if points is None else f"{points:g}" for points in (self.before, self.after))
        words = ""
        if self.before is None and self.diagnosis_after:
            words = f" ({self.diagnosis_after})"
        elif self.diagnosis_before != self.diagnosis_after:
            words = f" ({self.diagnosis_before or 'no mistake'} → {self.diagnosis_after or 'no mistake'})"
        return f"{self.student}  {self.exercise}  {points}{words}{f', {self.note}' if self.note else ''}"


def differences(before: Iterable[Row], after: Iterable[Row]) -> list[Difference]:
    """Return the differences between the rows of two tables, sorted by student, assignment and exercise."""
    earlier = {(row.student, row.assignment, row.exercise): row for row in before}
    later = {(row.student, row.assignment, row.exercise): row for row in after}
    found = []
    for key in sorted({*earlier, *later}):
        old, new = earlier.get(key), later.get(key)
        difference = Difference(
            *key,
            old.shown_score if old else None,
            new.shown_score if new else None,
            old.diagnosis if old else "",
            new.diagnosis if new else "",
        )
        if (difference.before, difference.diagnosis_before) != (difference.after, difference.diagnosis_after):
            found.append(difference)
    return found


def compare(store: ClassStore, before: str = "", after: str = "") -> tuple[str, str, list[Difference]]:
    """Compare the results of two runs of a class.

    Args:
        store: The store of the class.
        before: The name of the earlier run; if empty, the run before the last.
        after: The name of the later run; if empty, the last run.

    Returns:
        The names of the two runs, and their differences.

    Raises:
        GradingError: There are fewer than two runs, or no run has a given name.
    """
    names = store.runs()
    if len(names) < 2 and not (before and after):
        raise GradingError(
            "There is nothing to compare yet: this class does not have two runs with different results."
        )
    before, after = before or names[-2], after or names[-1]
    tables = []
    for name in (before, after):
        rows = store.run(name)
        if rows is None:
            raise GradingError(
                f"Run {name} does not exist. The runs are: {', '.join(names[-10:]) or 'none'}."
            )
        tables.append(rows)
    return before, after, differences(*tables)
