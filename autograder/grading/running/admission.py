"""Checks the answers of desks and workers, on this machine as on others, before anything in them is used.

A desk parses a student's file, and a worker executes students' programs, so a student may have taken over either. A
document of a desk is admitted if some notebook could have produced it. A worker's answer is admitted if it has the
form of an execution of the task, with points within the limits of the task's checks, and with outputs that contain
nothing that a browser would run.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import msgspec

from autograder.execution.cells import Execution
from autograder.execution.outputs import IMAGES, NotebookOutputs
from autograder.grading.rebuilding.parsing import BASE64
from autograder.grading.rebuilding.submission import (
    MAX_BYTES,
    MAX_CHARACTERS,
    ReadNotebook,
    Unreadable,
)
from autograder.grading.running.orders import LARGEST_ANSWER, Offer
from autograder.verdict import State

if TYPE_CHECKING:
    from autograder.boxes.limits import Limits
    from autograder.execution.cells import CellCheck, CellRun
    from autograder.grading.task import Task
    from autograder.verdict import Verdict

LARGEST_OFFER = 4_000
LARGEST_DOCUMENT = MAX_BYTES + 14_000_000
"""The maximum size of a desk's document, in bytes. Pictures are as long as in the file; each character of a text has up
to 6 bytes.
"""
_MOST_SLOTS = 1_000
_LONGEST_WORDS = 1_000


class Forged(ValueError):
    """The answer of a worker or desk is not possible. The message says why."""


def admitted_offer(data: bytes) -> Offer:
    """Return a worker's offer after checking it.

    Raises:
        Forged: The data is not a valid offer.
    """
    if len(data) > LARGEST_OFFER:
        raise Forged(f"its offer has {len(data)} bytes")
    try:
        offer = msgspec.json.decode(data, type=Offer)
    except msgspec.MsgspecError as error:
        raise Forged(f"its offer is not valid: {error}") from error
    if not 1 <= offer.slots <= _MOST_SLOTS:
        raise Forged(f"it offers to execute {offer.slots} notebooks at once")
    return offer


def admitted_notebook(data: bytes) -> ReadNotebook | Unreadable:
    """Return a desk's document after checking it.

    Raises:
        Forged: The data is not such a document.
    """
    if len(data) > LARGEST_DOCUMENT:
        raise Forged(f"its document has {len(data)} bytes")
    try:
        document = msgspec.json.decode(data, type=ReadNotebook | Unreadable)
    except (msgspec.MsgspecError, RecursionError, UnicodeError) as error:
        raise Forged(f"its document is not valid: {error}") from error
    if isinstance(document, Unreadable):
        return Unreadable(printable(document.reason))
    if sum(len(cell.source) for cell in document.cells) > MAX_CHARACTERS:
        raise Forged("its document has too many characters")
    for _, kind, picture in (one for cell in document.cells for one in cell.pictures):
        if kind not in IMAGES or not BASE64.fullmatch(picture):
            raise Forged("its document has a picture that is not a bitmap")
    return document


def admitted(data: bytes, task: Task) -> Execution:
    """Return the execution of a task from a worker's answer, after checking it and cleaning the outputs.

    Raises:
        Forged: The data is not an execution, or not an execution of this task.
    """
    if len(data) > LARGEST_ANSWER:
        raise Forged(f"its answer has {len(data)} bytes")
    try:
        execution = msgspec.json.decode(data, type=Execution)
    except (msgspec.MsgspecError, RecursionError) as error:
        raise Forged(f"its answer is not an execution: {error}") from error
    if len(execution.cells) not in ({len(task.cells), 0} if execution.trouble else {len(task.cells)}):
        raise Forged(f"its answer has {len(execution.cells)} cells, and the notebook has {len(task.cells)}")
    checks = {index: cell.check for index, cell in enumerate(task.cells) if cell.check is not None}
    if execution.verdicts.keys() != checks.keys():
        raise Forged("its verdicts are not those of the notebook's checks")
    if any(place not in range(len(task.cells)) for place in execution.as_typed):
        raise Forged("its answer names a cell that does not exist")
    for index, check in checks.items():
        _look_at(execution.verdicts[index], check)
    cells = _harmless(execution.cells, task.limits)
    return replace(execution, cells=cells, trouble=printable(execution.trouble))


def printable(text: str) -> str:
    """Return a worker's text as one line of limited length, without control characters."""
    return "".join(letter if letter.isprintable() else " " for letter in text[:_LONGEST_WORDS])


def _look_at(verdict: Verdict, check: CellCheck) -> None:
    if verdict.exercise != check.exercise:
        raise Forged(f"it judged {verdict.exercise!r:.60} instead of {check.exercise}")
    if verdict.max_score != check.points or not 0 <= verdict.score <= check.points:
        raise Forged(f"it gives {verdict.score:g} of {verdict.max_score:g} points for {check.exercise}")
    if verdict.state is State.NOT_CHECKED and verdict.score:
        raise Forged("it gives points for what could not be checked")


def _harmless(cells: tuple[CellRun, ...], limits: Limits) -> tuple[CellRun, ...]:
    """Return the cells with their outputs cut and cleaned again, as the sandbox should already have done."""
    outputs = NotebookOutputs(len(cells), limits.cell_output_bytes, limits.notebook_output_bytes)
    for index, cell in enumerate(cells):
        outputs.put(index, cell.outputs)
    return tuple(
        replace(cell, outputs=outputs.of(index), error=cell.error[:500]) for index, cell in enumerate(cells)
    )
