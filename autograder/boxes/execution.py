"""The input and the result of the execution of a notebook, as plain data that travels as JSON."""

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
class Check:
    """The check that a check cell makes.

    Attributes:
        exercise: The exercise's id, such as ``"lab_1_2.talker"``.
        title: The exercise's name for a person.
        points: Points the judge gives at most.
        worth: Points the cell carries in the gradebook; the judge's score is scaled to it.
        limit: Seconds of wall time that the judge allows itself.
        asserts: Whether the cell's own tests decide, by the rules of nbgrader, and not the judge.
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
        name: The grade_id, or empty for a cell of the student's own.
        own: Whether a student wrote the text.
    """

    source: str
    kind: CellType = CellType.CODE
    check: Check | None = None
    name: str = ""
    own: bool = False


class Ended(StrEnum):
    """The end of a cell's run."""

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
    """The kernel was gone, or the notebook's time was up, before the cell's turn."""


@dataclass(frozen=True)
class CellRun:
    """The result of one cell.

    Attributes:
        ended: How it ended.
        outputs: nbformat outputs, capped and stripped of what a browser would execute.
        error: ``"NameError: name 'x' is not defined"`` for a cell that raised, else empty. The student's own
            words.
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
        cells: One for each cell that went in, in order.
        verdicts: By index of the check cell; every check cell has one.
        trouble: What went wrong on the grader's own side, empty when all was well. Then no result is final.
        seconds: Wall time, start of the kernel included.
        start_seconds: Of these, until kernel and judge were ready.
        as_typed: The places of the cells whose text is too costly to be rendered on a page.
        crowded_out: It came to a limit, or failed, where it may well do better with nothing beside it: it says nothing.
        cpu_seconds: Processor time of what was in the student's boxes; 0 where nobody counts it.
        evidence: What the judge's verdicts follow from, by exercise, as the judge has packed it. Nothing looks into it
            while a class is graded.
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
        """True if it is to be executed once more, alone: others have perhaps used up what it was short of."""
        return bool(self.trouble) or self.crowded_out
