"""The records in the store of a class (:mod:`autograder.grading.class_store`), as plain data."""

from __future__ import annotations

import zlib
from dataclasses import dataclass
from datetime import datetime  # noqa: TC003  (msgspec reads the annotations)
from typing import TYPE_CHECKING, Self

import msgspec

from autograder.boxes.execution import CellType
from autograder.grading.reporting.rows import Row  # noqa: TC001  (the same)

if TYPE_CHECKING:
    from autograder.boxes.execution import Execution
    from autograder.grading.entering.gradebook_reading import SubmissionEntry
    from autograder.grading.task import Task


@dataclass(frozen=True)
class Attempt:
    """One time that a submission was graded and entered.

    Attributes:
        at: The time in UTC.
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
        """The attempt in one line for a person."""
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
    """The last entry of a submission into the gradebook, by which the next run knows the grades that are still right.

    Attributes:
        fingerprint: Of all that it was made from.
        tasks: The task of each notebook, as :meth:`autograder.grading.task.Task.key` has it.
        scores: The points of each check cell, by notebook and grade_id.
        rows: The same for the report, with what is wrong.
        course: Stands for the version of the course that it was graded with.
        shown: Stands for what the gradebook said when the pages of feedback were made; empty where none were.
    """

    fingerprint: str
    tasks: dict[str, str]
    scores: dict[str, dict[str, float]]
    rows: tuple[Row, ...]
    course: str
    shown: str = ""

    def is_in(self, entry: SubmissionEntry) -> bool:
        """True if the gradebook, whose entry this is, still has the points that were entered."""
        return all(
            entry.judged(notebook, name) == score
            for notebook, entered in self.scores.items()
            for name, score in entered.items()
        )


@dataclass(frozen=True)
class Origin:
    """The master that a source of a class was made of.

    Attributes:
        master: The master's file, below the course's top folder where it is there.
        text: Stands for the whole of it.
        work: Stands for its graded cells and those that students write.
    """

    master: str
    text: str
    work: str


class RunCell(msgspec.Struct, frozen=True, array_like=True):
    """A cell that was run and is the student's own, or a check cell.

    Attributes:
        name: Its grade_id; empty for a cell that the student has added.
        text: The student's text; empty for a check cell.
        checks: The exercise that it checks; empty for any other cell.
    """

    name: str
    text: str
    checks: str


@dataclass(frozen=True)
class KeptEvidence:
    """The evidence of a student's notebook, with the cells that were run. It is no grade.

    Attributes:
        assignment: The assignment's name.
        notebook: The notebook's name.
        task: The task that was executed, as :meth:`autograder.grading.task.Task.key` has it.
        course: Stands for the version of the course.
        checks: By exercise, as the judge has packed it (:mod:`autograder.judge.verdicts.keeping`).
        cells: The cells that tell what was judged, in their order: a list of :class:`RunCell`, compressed.
    """

    assignment: str
    notebook: str
    task: str
    course: str
    checks: dict[str, bytes]
    cells: bytes

    @classmethod
    def of(cls, task: Task, execution: Execution) -> Self:
        """The evidence of a task that was executed."""
        run = [
            RunCell(cell.name, "" if cell.check else cell.source, cell.check.exercise if cell.check else "")
            for cell in task.cells
            if cell.kind is CellType.CODE and (cell.own or cell.check)
        ]
        packed = zlib.compress(msgspec.msgpack.encode(run), 1)
        return cls(task.assignment, task.notebook, task.key(), task.course, execution.evidence, packed)

    def run_cells(self) -> list[RunCell]:
        """The cells that were judged.

        Raises:
            ValueError: They are damaged.
        """
        try:
            return msgspec.msgpack.decode(zlib.decompress(self.cells), type=list[RunCell])
        except (zlib.error, msgspec.MsgspecError) as error:
            raise ValueError(str(error)) from error
