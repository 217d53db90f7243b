"""The input and the result of executing a notebook, as plain data that travels as JSON."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any

from autograder.verdict import Verdict  # noqa: TC001  (msgspec reads the annotations)


class CellType(StrEnum):
    """The type of a cell, in nbformat's words."""

    CODE = "code"
    MARKDOWN = "markdown"
    RAW = "raw"


@dataclass(frozen=True)
class CellCheck:
    """The check that a check cell makes.

    Attributes:
        exercise: The exercise's id, such as ``"lab_1_2.talker"``.
        title: The exercise's name as people see it.
        points: The most points that the judge gives.
        worth: The cell's points in the gradebook; the judge's score is scaled to them.
        limit: The judge's time limit in seconds of wall time.
        asserts: True if the cell's own tests decide, by nbgrader's rules, instead of the judge.
    """

    exercise: str
    title: str
    points: float
    worth: float
    limit: float
    asserts: bool = False


@dataclass(frozen=True)
class Cell:
    """One cell to execute.

    Attributes:
        source: The text of the cell.
        kind: Only code cells are executed.
        check: Set on a check cell.
        name: The grade_id; empty for a cell that the student added.
        own: True if a student wrote the text.
    """

    source: str
    kind: CellType = CellType.CODE
    check: CellCheck | None = None
    name: str = ""
    own: bool = False


class Ended(StrEnum):
    """How the run of a cell ended."""

    DONE = "done"
    RAISED = "raised"
    TIMED_OUT = "timed_out"
    KERNEL_DIED = "kernel_died"
    OUT_OF_MEMORY = "out_of_memory"
    OUT_OF_CPU = "out_of_cpu"
    TOO_MANY_PROCESSES = "too_many_processes"
    TOO_MANY_FILES = "too_many_files"
    TOO_MANY_LOCKS = "too_many_locks"
    TOO_MUCH_OUTPUT = "too_much_output"
    NOT_RUN = "not_run"
    """The kernel was gone, or the notebook's time was up, before this cell could run."""


@dataclass(frozen=True)
class CellRun:
    """The result of one cell.

    Attributes:
        ended: How it ended.
        outputs: nbformat outputs, limited in size and without anything that a browser would execute.
        error: ``"NameError: name 'x' is not defined"`` for a cell that raised, else empty. The text comes from the
            student's code.
        seconds: Wall time.
    """

    ended: Ended
    outputs: tuple[dict[str, Any], ...] = ()
    error: str = ""
    seconds: float = 0.0


@dataclass(frozen=True)
class Execution:
    """The result of a notebook.

    Attributes:
        cells: One result for each cell that was given, in order.
        verdicts: By index of the check cell; every check cell has one.
        trouble: A failure of the grader itself; empty if there was none. With a failure, no result is final.
        seconds: Wall time, the start of the kernel included.
        start_seconds: The part of it until kernel and judge were ready.
        as_typed: The indexes of the cells whose text is too costly to render on a page.
        crowded_out: True if it failed or reached a limit perhaps only because other work ran at the same time.
        cpu_seconds: Processor time used in the student's boxes; 0 if it is not counted.
        evidence: What the judge's verdicts follow from, by exercise, as the judge packed it. It is not opened while a
            class is graded.
    """

    cells: tuple[CellRun, ...]
    verdicts: dict[int, Verdict] = field(default_factory=dict)
    trouble: str = ""
    seconds: float = 0.0
    start_seconds: float = 0.0
    as_typed: tuple[int, ...] = ()
    crowded_out: bool = False
    cpu_seconds: float = 0.0
    evidence: dict[str, bytes] = field(default_factory=dict)

    @property
    def says_nothing(self) -> bool:
        """True if it should be executed again, alone: other work may have used up what it lacked."""
        return bool(self.trouble) or self.crowded_out
