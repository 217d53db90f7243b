"""Checks the answers of desks and workers before the grader uses anything in them.

A student's file may have taken over the desk that parsed it, and a student's program may have taken over the worker
that executed it. So a desk's document is accepted only if a notebook could have produced it. And a worker's answer is
accepted only if it has the form of an execution of the task, and no check in it gives more than the check's maximum
points. Everything that a browser would run is removed from the outputs.
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
"""The maximum size of a desk's document, in bytes. It is larger than the limit for a student's file, because the
document is JSON, in which a character of text takes up to 6 bytes. A picture is equally long in both.
"""
_MOST_SLOTS = 1_000
_LONGEST_WORDS = 1_000


class Forged(ValueError):
    """A worker or desk gave an answer that an unmodified one would never give, for the reason in the message."""


def admitted_offer(data: bytes) -> Offer:
    """Decode and check a worker's offer, and return it.

    Raises:
        Forged: The data is not a valid offer.
    """
    if len(data) > LARGEST_OFFER:
        raise Forged(f"the worker's offer has {len(data)} bytes")
    try:
        offer = msgspec.json.decode(data, type=Offer)
    except msgspec.MsgspecError as error:
        raise Forged(f"the worker's offer is not valid: {error}") from error
    if not 1 <= offer.slots <= _MOST_SLOTS:
        raise Forged(f"the worker offers to execute {offer.slots} notebooks at the same time")
    return offer


def admitted_notebook(data: bytes) -> ReadNotebook | Unreadable:
    """Decode and check a desk's document, and return it.

    Raises:
        Forged: The data is not a document that a desk could have made from a notebook.
    """
    if len(data) > LARGEST_DOCUMENT:
        raise Forged(f"the desk's document has {len(data)} bytes")
    try:
        document = msgspec.json.decode(data, type=ReadNotebook | Unreadable)
    except (msgspec.MsgspecError, RecursionError, UnicodeError) as error:
        raise Forged(f"the desk's document is not valid: {error}") from error
    if isinstance(document, Unreadable):
        return Unreadable(printable(document.reason))
    if sum(len(cell.source) for cell in document.cells) > MAX_CHARACTERS:
        raise Forged("the desk's document has too many characters")
    for _, kind, picture in (one for cell in document.cells for one in cell.pictures):
        if kind not in IMAGES or not BASE64.fullmatch(picture):
            raise Forged("the desk's document has a picture that is not a bitmap")
    return document


def admitted(data: bytes, task: Task) -> Execution:
    """Decode and check a worker's answer to a task, and return the execution with cleaned outputs.

    Raises:
        Forged: The data is not an execution, or not an execution of this task.
    """
    if len(data) > LARGEST_ANSWER:
        raise Forged(f"the answer has {len(data)} bytes")
    try:
        execution = msgspec.json.decode(data, type=Execution)
    except (msgspec.MsgspecError, RecursionError) as error:
        raise Forged(f"the answer is not an execution: {error}") from error
    if len(execution.cells) not in ({len(task.cells), 0} if execution.trouble else {len(task.cells)}):
        raise Forged(f"the answer has {len(execution.cells)} cells, and the notebook has {len(task.cells)}")
    checks = {index: cell.check for index, cell in enumerate(task.cells) if cell.check is not None}
    if execution.verdicts.keys() != checks.keys():
        raise Forged("the answer has verdicts on other checks than the notebook has")
    if any(place not in range(len(task.cells)) for place in execution.as_typed):
        raise Forged("the answer names a cell that does not exist")
    for index, check in checks.items():
        _look_at(execution.verdicts[index], check)
    cells = _harmless(execution.cells, task.limits)
    return replace(execution, cells=cells, trouble=printable(execution.trouble))


def printable(text: str) -> str:
    """Return a worker's text as one line of limited length, without control characters."""
    return "".join(letter if letter.isprintable() else " " for letter in text[:_LONGEST_WORDS])


def _look_at(verdict: Verdict, check: CellCheck) -> None:
    if verdict.exercise != check.exercise:
        raise Forged(f"the answer has a verdict on {verdict.exercise!r:.60} instead of {check.exercise}")
    if verdict.max_score != check.points or not 0 <= verdict.score <= check.points:
        raise Forged(
            f"the answer gives {verdict.score:g} of {verdict.max_score:g} points for {check.exercise}"
        )
    if verdict.state is State.NOT_CHECKED and verdict.score:
        raise Forged("the answer gives points for an exercise that could not be checked")


def _harmless(cells: tuple[CellRun, ...], limits: Limits) -> tuple[CellRun, ...]:
    """Cut and clean the outputs of the cells again: the worker should have done so, but is not trusted."""
    outputs = NotebookOutputs(len(cells), limits.cell_output_bytes, limits.notebook_output_bytes)
    for index, cell in enumerate(cells):
        outputs.put(index, cell.outputs)
    return tuple(
        replace(cell, outputs=outputs.of(index), error=cell.error[:500]) for index, cell in enumerate(cells)
    )
