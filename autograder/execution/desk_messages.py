"""The orders to a kernel's desk and the desk's answers: lines of JSON on a socket.

The desk (``kernel_desk.py``) reads what a student's program says, so the program may have taken the
desk over. An answer is a document of this form or it is not used.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence  # noqa: TC003  (msgspec reads the annotations)
from dataclasses import dataclass
from enum import StrEnum
from typing import Annotated, Literal

import msgspec

from autograder.execution.outputs import TRACEBACK_LINES

MOST_ESCAPED = 8
"""The most bytes in an answer for each byte of output. A control character takes six."""
FURTHER_BYTES = 1_000_000
"""Limit in bytes of everything else in an answer."""


@dataclass(frozen=True)
class Setting:
    """What a desk is told when it starts.

    Attributes:
        address: The path in the names of the kernel's sockets.
        key: The key that signs the messages.
        message_bytes: See :class:`autograder.boxes.limits.Limits`, as for the others.
        flood_bytes: See there.
        cell_output_bytes: See there.
        notebook_output_bytes: See there.
    """

    address: str
    key: str
    message_bytes: int
    flood_bytes: int
    cell_output_bytes: int
    notebook_output_bytes: int


class Do(StrEnum):
    """The kinds of orders."""

    EXECUTE = "execute"
    """Execute a cell, and answer when it has ended."""
    SETTLE = "settle"
    """The cell was interrupted: answer when the kernel has ended it, or takes requests again."""
    DRAIN = "drain"
    """The kernel has ended: answer when everything that it has sent has been read."""


class Order(msgspec.Struct, frozen=True):
    """One order. The desk answers each exactly once, in order; a new one ends the wait for the one before.

    Attributes:
        number: Counted from 1; the answer has the same number. The answer 0 says that the kernel is ready.
        do: What to do.
        cell: The index of the cell to execute.
        source: The text of the cell.
    """

    number: int
    do: Do
    cell: int = 0
    source: str = ""


class Said(StrEnum):
    """How an order ended."""

    DONE = "done"
    RAISED = "raised"
    EXITS = "exits"
    """The cell has called ``exit()`` or ``quit()``: the kernel answers first, and ends a moment later."""
    FLOODS = "floods"
    """The cell has sent too much, and still runs."""
    OPEN = "open"
    """The next order came before the end of this one."""


class _Output(msgspec.Struct, frozen=True, tag_field="output_type", forbid_unknown_fields=True):
    """An output of a cell, in nbformat's format."""


class Stream(_Output, frozen=True, tag="stream"):
    """Printed text."""

    name: Literal["stdout", "stderr"]
    text: str


class Display(_Output, frozen=True, tag="display_data"):
    """Something shown, by media type."""

    data: Annotated[
        Mapping[Literal["text/plain", "image/png", "image/jpeg"], str], msgspec.Meta(max_length=3)
    ]
    metadata: Annotated[Mapping[str, str], msgspec.Meta(max_length=0)]


class Result(Display, frozen=True, tag="execute_result"):
    """The value of a cell."""

    execution_count: None


class Failure(_Output, frozen=True, tag="error"):
    """The error that ended a cell."""

    ename: str
    evalue: str
    traceback: Annotated[Sequence[str], msgspec.Meta(max_length=TRACEBACK_LINES)]


class Answer(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The answer to an order.

    Attributes:
        number: The number of the order.
        said: How it ended.
        outputs: By the index of the cell, all outputs of each cell that has new ones since the last answer.
    """

    number: int
    said: Said
    outputs: Mapping[int, Sequence[Stream | Display | Result | Failure]]


def admitted_answer(line: bytes, orders: range, cells: Collection[int]) -> Answer:
    """Return an answer of the desk, checked.

    Args:
        line: What the desk said.
        orders: The numbers of the orders that wait for an answer.
        cells: The indexes of the cells that were executed.

    Raises:
        ValueError: It is not an answer to one of these orders.
    """
    try:
        answer = msgspec.json.decode(line, type=Answer)
    except RecursionError as error:
        raise ValueError("it is nested too deeply") from error
    if answer.number not in orders or not all(cell in cells for cell in answer.outputs):
        raise ValueError("it is about something else")
    return answer
