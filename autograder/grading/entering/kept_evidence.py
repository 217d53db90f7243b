"""The evidence of the checks that were made last, beside the journal: what an appeal is judged by. It is no grade."""

from __future__ import annotations

import contextlib
import zlib
from dataclasses import replace
from typing import TYPE_CHECKING

import msgspec

from autograder.boxes.execution import CellType
from autograder.regular_files import write_whole

if TYPE_CHECKING:
    from pathlib import Path

    from autograder.boxes.execution import Execution
    from autograder.grading.classes.class_directory import ClassDirectory
    from autograder.grading.task import Task


class RunCell(msgspec.Struct, frozen=True, array_like=True):
    """A cell that was run and is the student's own, or a check cell.

    Attributes:
        name: Its grade_id; empty for a cell that the student has added.
        text: What the student wrote; empty for a check cell.
        checks: The exercise that it checks; empty for any other cell.
    """

    name: str
    text: str
    checks: str


class OfNotebook(msgspec.Struct, frozen=True):
    """The evidence of one student's notebook.

    Attributes:
        key: The task that was executed, as :meth:`autograder.grading.task.Task.key` has it.
        course: Stands for the version of the course.
        checks: By exercise, as the judge has packed it (:mod:`autograder.judge.verdicts.keeping`).
        run: The cells that tell what was judged, in their order: a list of :class:`RunCell`, compressed.
    """

    key: str
    course: str
    checks: dict[str, bytes]
    run: bytes

    def cells(self) -> list[RunCell]:
        """The cells that were judged.

        Raises:
            ValueError: It is damaged.
        """
        try:
            return msgspec.msgpack.decode(zlib.decompress(self.run), type=list[RunCell])
        except (zlib.error, msgspec.MsgspecError) as error:
            raise ValueError(str(error)) from error


class EvidenceFolder:
    """One file a student's notebook, replaced as a whole.

    Args:
        directory: The class.
    """

    def __init__(self, directory: ClassDirectory) -> None:
        self._folder = directory.state / "evidence"

    def keep(self, task: Task, execution: Execution) -> Execution:
        """Keep what the judge has handed over; the execution without it.

        Where the grader itself had trouble, what was kept before stays: the next run tries again.

        Raises:
            OSError: It could not be written.
        """
        path = self._path(task.assignment, task.notebook, task.student)
        if execution.evidence and not execution.trouble:
            cells = [
                RunCell(
                    cell.name, "" if cell.check else cell.source, cell.check.exercise if cell.check else ""
                )
                for cell in task.cells
                if cell.kind is CellType.CODE and (cell.own or cell.check)
            ]
            run = zlib.compress(msgspec.msgpack.encode(cells), 1)
            of_notebook = OfNotebook(task.key(), task.course, execution.evidence, run)
            write_whole(path, msgspec.msgpack.encode(of_notebook))
        elif not execution.trouble:
            path.unlink(missing_ok=True)
        return replace(execution, evidence={})

    def find(self, student: str, exercise: str) -> tuple[str, str, OfNotebook] | None:
        """The notebook in which a student's check was made last, and its assignment; None where nothing is kept."""
        for path in sorted(self._folder.glob("*/*.msgpack")):
            notebook, _, whose = path.stem.partition("@")
            if whose == student:
                with contextlib.suppress(OSError, msgspec.MsgspecError):  # a damaged file counts as none
                    found = msgspec.msgpack.decode(path.read_bytes(), type=OfNotebook)
                    if exercise in found.checks:
                        return path.parent.name, notebook, found
        return None

    def _path(self, assignment: str, notebook: str, student: str) -> Path:
        return self._folder / assignment / f"{notebook}@{student}.msgpack"
