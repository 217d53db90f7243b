"""Defines the records in a class's store (:mod:`autograder.grading.class_store`)."""

from __future__ import annotations

import zlib
from collections.abc import Mapping  # noqa: TC003  (msgspec reads the annotations)
from dataclasses import dataclass, field
from datetime import datetime  # noqa: TC003  (the same)
from typing import TYPE_CHECKING, Self

import msgspec

from autograder.execution.executed_cells import CellType
from autograder.grading.table.rows import Row  # noqa: TC001  (the same)

if TYPE_CHECKING:
    from autograder.execution.executed_cells import Execution
    from autograder.grading.classes.gradebook_reading import SubmissionEntry
    from autograder.grading.grading_task import Task


_PARTS = {
    "handed_in": "the submission",
    "released": "the released notebook",
    "exercises": "the exercise",
    "judge": "the judge",
    "settings": "the settings of the class",
    "grader": "the grader",
}
"""The names of a key's parts in messages."""


@dataclass(frozen=True)
class ResultKey:
    """The parts from which the results of a submission were made, each as a hash.

    A part is empty if the record was made by an earlier version of the course, which had one hash for all parts.

    Attributes:
        handed_in: The submitted notebooks and the time of handing in.
        released: The assignment's files in ``source``, from which the released notebook was made.
        exercises: The exercises that judge the notebooks, with their reference outputs.
        judge: The code of the course that executes and judges notebooks.
        settings: The configuration of the class, its secret, and whether the sandbox is on.
        grader: The code of the course that makes tasks from notebooks, and cards, grades and pages from results. If
            only this part changed, grades and pages are made again from the stored results.
    """

    handed_in: str = ""
    released: str = ""
    exercises: str = ""
    judge: str = ""
    settings: str = ""
    grader: str = ""

    def changes_since(self, earlier: ResultKey) -> str:
        """Return a sentence about the parts that differ from an earlier key; empty if none does."""
        if not earlier.judge:
            return "an earlier version of the course had graded it"
        changed = [words for part, words in _PARTS.items() if getattr(self, part) != getattr(earlier, part)]
        return f"{' and '.join(changed)} changed" if changed else ""


@dataclass(frozen=True)
class Attempt:
    """One grading of a submission, with everything by which a run recognizes that the gradebook contains its results.

    Attributes:
        at: The time of the grading, in UTC.
        made_from: The key of the results.
        course: The version of the course that judged the submission.
        rows: The judge's results, as rows of the report.
        earlier: The key of the student's attempt before this one at the same assignment; None if this is the first, or
            if only the attempts in the gradebook were asked for.
        tasks: The hash of each notebook's task, from :meth:`autograder.grading.grading_task.Task.key`.
        scores: The points of each check cell, by notebook and grade_id.
        shown: The hash of the gradebook's entry from which the feedback pages were made; empty without pages.
    """

    at: datetime
    assignment: str
    made_from: ResultKey
    course: str
    rows: tuple[Row, ...]
    earlier: ResultKey | None = None
    tasks: Mapping[str, str] = field(default_factory=dict)
    scores: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    shown: str = ""

    def line(self) -> str:
        """Return the attempt as a line of text."""
        score, most = sum(row.score for row in self.rows), sum(row.max_score for row in self.rows)
        why = self.made_from.changes_since(self.earlier) if self.earlier else "first attempt"
        words = [
            f"{row.exercise} {row.score:g}" + (f" ({row.diagnosis})" if row.diagnosis else "")
            for row in self.rows
        ]
        return (
            f"{self.at:%Y-%m-%d %H:%M:%S} UTC  {self.assignment}  {score:g}/{most:g}  {', '.join(words)}  "
            f"[{why or 'nothing changed'}, course {self.course[:8]}]"
        )

    def missing_in(self, entry: SubmissionEntry) -> list[str]:
        """Return the points that a gradebook entry does not contain, or no longer contains, each as words."""
        return [
            f"{score:g} points for {name} in {notebook}"
            for notebook, scores in self.scores.items()
            for name, score in scores.items()
            if entry.judged(notebook, name) != score
        ]


@dataclass(frozen=True)
class Origin:
    """The master from which a source notebook of a class was made, as the master was then.

    Attributes:
        master: The path of the master, relative to the course if it is inside the course.
        text: A hash of the master's whole text.
        work: A hash of the graded cells and the answer cells.
    """

    master: str
    text: str
    work: str


class RunCell(msgspec.Struct, frozen=True, array_like=True):
    """A cell that was executed: a cell that a student wrote, or a check cell.

    Attributes:
        name: The grade_id of the cell; empty for a cell that the student added.
        text: The student's text; empty for a check cell.
        checks: For a check cell, the id of its exercise; empty for another cell.
    """

    name: str
    text: str
    checks: str


@dataclass(frozen=True)
class KeptEvidence:
    """The evidence of all checks in a student's notebook, for appeals. It has no influence on grades.

    Attributes:
        task: The hash of the executed task, from :meth:`autograder.grading.grading_task.Task.key`.
        checks: The evidence by exercise, as packed by the judge (:mod:`autograder.judge.evidence_files`).
        cells: The executed cells: a list of :class:`RunCell`, encoded with MessagePack and compressed.
    """

    assignment: str
    notebook: str
    task: str
    course: str
    checks: dict[str, bytes]
    cells: bytes

    @classmethod
    def of(cls, task: Task, execution: Execution) -> Self:
        """Return the evidence of an executed task in the form to store."""
        run = [
            RunCell(cell.name, "" if cell.check else cell.source, cell.check.exercise if cell.check else "")
            for cell in task.cells
            if cell.kind is CellType.CODE and (cell.own or cell.check)
        ]
        packed = zlib.compress(msgspec.msgpack.encode(run), 1)
        return cls(task.assignment, task.notebook, task.key(), task.course, execution.evidence, packed)

    def run_cells(self) -> list[RunCell]:
        """Return the executed cells.

        Raises:
            ValueError: The stored cells are damaged.
        """
        try:
            return msgspec.msgpack.decode(zlib.decompress(self.cells), type=list[RunCell])
        except (zlib.error, msgspec.MsgspecError) as error:
            raise ValueError(str(error)) from error
