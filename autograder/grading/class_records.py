"""The records in a class's store (:mod:`autograder.grading.class_store`), as plain data."""

from __future__ import annotations

import zlib
from dataclasses import dataclass
from datetime import datetime  # noqa: TC003  (msgspec reads the annotations)
from typing import TYPE_CHECKING, Self

import msgspec

from autograder.execution.cells import CellType
from autograder.grading.reporting.rows import Row  # noqa: TC001  (the same)

if TYPE_CHECKING:
    from autograder.execution.cells import Execution
    from autograder.grading.gradebooks.gradebook_reading import SubmissionEntry
    from autograder.grading.task import Task


@dataclass(frozen=True)
class Attempt:
    """One grading of a submission whose results were entered into the gradebook.

    Attributes:
        at: The time of the grading, in UTC.
        assignment: The assignment's name.
        work: A hash of the submission and of everything used to grade it. It is unchanged as long as both are.
        course: The version of the course that was used.
        rows: The judge's results, as rows of the report.
    """

    at: datetime
    assignment: str
    work: str
    course: str
    rows: tuple[Row, ...]

    def line(self) -> str:
        """Return the attempt as a line of text."""
        score, most = sum(row.score for row in self.rows), sum(row.max_score for row in self.rows)
        words = [
            f"{row.exercise} {row.score:g}" + (f" ({row.diagnosis})" if row.diagnosis else "")
            for row in self.rows
        ]
        return (
            f"{self.at:%Y-%m-%d %H:%M:%S} UTC  {self.assignment}  {score:g}/{most:g}  {', '.join(words)}  "
            f"[work {self.work[:8]}, course {self.course[:8]}]"
        )


@dataclass(frozen=True)
class Entered:
    """The last entry of a submission in the gradebook. The next run uses it to find grades that are still right.

    Attributes:
        fingerprint: A hash of everything from which the grades were made.
        tasks: The hash of each notebook's task, from :meth:`autograder.grading.task.Task.key`.
        scores: The points of each check cell, by notebook and grade_id.
        rows: The results as rows of the report, with the recognized mistakes.
        course: The version of the course with which it was graded.
        shown: A hash of the gradebook's entries from which the feedback pages were made; empty if there are no pages.
    """

    fingerprint: str
    tasks: dict[str, str]
    scores: dict[str, dict[str, float]]
    rows: tuple[Row, ...]
    course: str
    shown: str = ""

    def is_in(self, entry: SubmissionEntry) -> bool:
        """Return True if this gradebook entry still contains the points that were entered."""
        return all(
            entry.judged(notebook, name) == score
            for notebook, entered in self.scores.items()
            for name, score in entered.items()
        )


@dataclass(frozen=True)
class Origin:
    """The master from which a source notebook of a class was made.

    Attributes:
        master: The file of the master. If it is inside the course, the path is relative to the course.
        text: A hash of the master's whole text.
        work: A hash of only those cells that are graded or that students write.
    """

    master: str
    text: str
    work: str


class RunCell(msgspec.Struct, frozen=True, array_like=True):
    """A cell that was run: a cell that a student wrote, or a check cell.

    Attributes:
        name: The grade_id of the cell; empty for a cell that the student added.
        text: The student's text; empty for a check cell.
        checks: The id of the exercise that it checks; empty if it is not a check cell.
    """

    name: str
    text: str
    checks: str


@dataclass(frozen=True)
class KeptEvidence:
    """The evidence about a student's notebook, with the cells that were run. It has no influence on a grade.

    Attributes:
        assignment: The assignment's name.
        notebook: The notebook's name.
        task: The hash of the executed task, from :meth:`autograder.grading.task.Task.key`.
        course: The version of the course.
        checks: The evidence by exercise, as packed by the judge (:mod:`autograder.judge.verdicts.keeping`).
        cells: The cells that show what was judged, in order: a list of :class:`RunCell`, compressed.
    """

    assignment: str
    notebook: str
    task: str
    course: str
    checks: dict[str, bytes]
    cells: bytes

    @classmethod
    def of(cls, task: Task, execution: Execution) -> Self:
        """Return the evidence of an executed task as it will be stored."""
        run = [
            RunCell(cell.name, "" if cell.check else cell.source, cell.check.exercise if cell.check else "")
            for cell in task.cells
            if cell.kind is CellType.CODE and (cell.own or cell.check)
        ]
        packed = zlib.compress(msgspec.msgpack.encode(run), 1)
        return cls(task.assignment, task.notebook, task.key(), task.course, execution.evidence, packed)

    def run_cells(self) -> list[RunCell]:
        """Return the cells that were judged.

        Raises:
            ValueError: The stored cells are damaged.
        """
        try:
            return msgspec.msgpack.decode(zlib.decompress(self.cells), type=list[RunCell])
        except (zlib.error, msgspec.MsgspecError) as error:
            raise ValueError(str(error)) from error
