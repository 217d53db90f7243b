"""Points that fell although the same files were handed in: the earlier points stay until the instructor says yes.

A judge may become stricter, or err on a busy machine. Neither takes points from a student without a word.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import msgspec

from autograder.grading.table.rows import grouped, rows_of
from autograder.safe_files import write_whole

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping
    from pathlib import Path

    from autograder.execution.executed_cells import Execution
    from autograder.grading.class_records import Attempt
    from autograder.grading.grading_task import Task


class FallenResult(msgspec.Struct, frozen=True):
    """A result that is lower than an earlier one of the same files, and does not count yet.

    Attributes:
        student: The id of the student.
        assignment: The name of the assignment.
        exercise: The id of the exercise.
        before: The earlier points, which count.
        after: The points of the new run.
        why: The reason for the new run.
    """

    student: str
    assignment: str
    exercise: str
    before: float
    after: float
    why: str


class FallenPoints:
    """The results of a class that wait for the instructor's yes or no.

    Args:
        state: The class's folder for the autograder's own files.
    """

    def __init__(self, state: Path) -> None:
        self._path = state / "fallen.json"
        self.results: tuple[FallenResult, ...] = ()
        if self._path.exists():
            self.results = msgspec.json.decode(self._path.read_bytes(), type=tuple[FallenResult, ...])

    def has(self, student: str, assignment: str) -> bool:
        """Return True if a result of a submission waits."""
        return any((one.student, one.assignment) == (student, assignment) for one in self.results)

    def add(self, found: Iterable[FallenResult]) -> None:
        """Add results, instead of earlier ones of the same exercises."""
        new = {(one.student, one.assignment, one.exercise): one for one in (*self.results, *found)}
        self._write(new.values())

    def forget(self, answered: Callable[[str, str], bool]) -> None:
        """Remove the results of submissions, by student and assignment, about which the instructor has decided."""
        self._write(one for one in self.results if not answered(one.student, one.assignment))

    def rename(self, ids: Mapping[str, str]) -> None:
        """Give students other ids: the new ids by the old ones."""
        self._write(
            msgspec.structs.replace(one, student=ids.get(one.student, one.student)) for one in self.results
        )

    def _write(self, results: Iterable[FallenResult]) -> None:
        found = tuple(results)
        if found != self.results:
            self.results = found
            write_whole(self._path, msgspec.json.encode(found))


def fallen(task: Task, execution: Execution, earlier: Attempt | None, why: str) -> list[FallenResult]:
    """Return the results of a notebook that are lower than in an earlier attempt with the same files."""
    before = {row.exercise: row.score for row in earlier.rows} if earlier and not execution.trouble else {}
    return [
        FallenResult(row.student, row.assignment, row.exercise, before[row.exercise], row.score, why)
        for row in rows_of(task, execution)
        if row.score < before.get(row.exercise, 0.0)
    ]


def fits(task: Task, execution: Execution) -> bool:
    """Return True if an earlier result is about the same checks, in the same cells, as a task."""
    checks = {index: cell.check.exercise for index, cell in enumerate(task.cells) if cell.check}
    return checks == {index: verdict.exercise for index, verdict in execution.verdicts.items()}


def questions(results: Iterable[FallenResult], command: str) -> Iterator[str]:
    """Yield a question for each exercise whose points fell, with all students whom it concerns."""
    for (exercise, why), several in grouped(results, lambda one: (one.exercise, one.why)).items():
        names = ", ".join(f"{one.student} {one.before:g} → {one.after:g}" for one in several)
        yield (
            f"{exercise}, on the same files ({why}): {names}. The earlier points stay. To take the new ones, type "
            f"{command} --lower yes; to keep the earlier ones, --lower no"
        )
