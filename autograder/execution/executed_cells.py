"""The input and the result of executing a notebook, as plain data that is sent as JSON."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any

from autograder.boxes.run_limits import Ended  # noqa: TC001  (msgspec reads the annotations)
from autograder.verdict import Verdict  # noqa: TC001  (msgspec reads the annotations)


class CellType(StrEnum):
    """The type of a cell, with nbformat's names."""

    CODE = "code"
    MARKDOWN = "markdown"
    RAW = "raw"


@dataclass(frozen=True)
class CellCheck:
    """The check that a check cell requests.

    Attributes:
        exercise: The exercise's id, such as ``"lab_1_2.talker"``.
        title: The exercise's title for people.
        points: The maximum points that the judge gives.
        worth: The cell's maximum points in the gradebook. The judge's score is scaled to them.
        limit: The judge's time limit in seconds of wall time.
        asserts: True if the cell's own tests decide, by nbgrader's rules, and not the judge.
    """

    exercise: str
    title: str
    points: float
    worth: float
    limit: float
    asserts: bool = False


@dataclass(frozen=True)
class Cell:
    """A cell to execute.

    Attributes:
        source: The text of the cell.
        kind: The type of the cell. Only code cells are executed.
        check: The check, if this is a check cell.
        name: The grade_id of the cell; empty for a cell that the student added.
        own: True if a student wrote the text.
    """

    source: str
    kind: CellType = CellType.CODE
    check: CellCheck | None = None
    name: str = ""
    own: bool = False


@dataclass(frozen=True)
class CellRun:
    """The result of one cell.

    Attributes:
        ended: How the execution of the cell ended.
        outputs: Outputs in nbformat's form, limited in size and without anything that a browser would execute.
        error: For a cell that raised an error, a text such as ``"NameError: name 'x' is not defined"``, else empty.
            The text comes from the student's code.
        seconds: The duration in seconds of wall time.
    """

    ended: Ended
    outputs: tuple[dict[str, Any], ...] = ()
    error: str = ""
    seconds: float = 0.0


@dataclass(frozen=True)
class Execution:
    """The result of executing a notebook.

    Attributes:
        cells: The results of the cells that were given, in the same order.
        verdicts: The verdicts by the index of the check cell. Every check cell has one.
        trouble: A failure of the grader itself; empty if there was none. With such a failure, no result is final.
        seconds: The duration in seconds of wall time, including the start of the kernel.
        start_seconds: The part of ``seconds`` until kernel and judge were ready.
        as_typed: The indexes of the text cells that a page shows as plain text, because rendering their Markdown takes
            too long.
        crowded_out: True if the notebook may have failed only because other work ran at the same time.
        cpu_seconds: The processor time in seconds that was used in the student's boxes; 0 if it is not counted.
        evidence: The evidence for the judge's verdicts, by exercise, packed. Grading does not unpack it.
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
        """True if the notebook should run again, alone: the grader failed, or other work may have used up resources."""
        return bool(self.trouble) or self.crowded_out
