"""The orders to a kernel's desk and the desk's answers: lines of JSON on a socket.

The desk (``kernel_desk.py``) reads the messages of a student's program, so that program may have taken control of the
desk. The grader therefore uses an answer only if it has exactly the form that is defined here.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence  # noqa: TC003  (msgspec reads the annotations)
from enum import StrEnum
from typing import Annotated, Literal

import msgspec

from autograder.boxes.admission import NotAdmitted, admitted
from autograder.execution.executed_cells import TRACEBACK_LINES

MOST_ESCAPED = 8
"""The maximum number of bytes in an answer for each byte of output. In JSON, a control character takes six bytes."""
FURTHER_BYTES = 1_000_000
"""The maximum number of bytes in an answer in addition to the outputs."""


class Do(StrEnum):
    """The kinds of orders."""

    EXECUTE = "execute"
    """Tells the desk to have the kernel execute a cell. The desk answers when the cell has ended."""
    SETTLE = "settle"
    """Tells the desk that the cell was interrupted. The desk answers when the kernel has ended the cell, or accepts
    requests again.
    """
    DRAIN = "drain"
    """Tells the desk that the kernel has ended. The desk answers when it has read everything that the kernel sent."""


class DeskOrder(msgspec.Struct, frozen=True):
    """One order. The desk answers each order once. If a new order comes first, the desk answers the earlier at once.

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
    """The cell has called ``exit()`` or ``quit()``. The kernel has answered, and ends a moment later."""
    FLOODS = "floods"
    """The cell has sent too much, and still runs."""
    OPEN = "open"
    """The next order came before this order was finished."""


class _Output(msgspec.Struct, frozen=True, tag_field="output_type", forbid_unknown_fields=True):
    """An output of a cell, in nbformat's format."""


class Stream(_Output, frozen=True, tag="stream"):
    """Printed text."""

    name: Literal["stdout", "stderr"]
    text: str


class Display(_Output, frozen=True, tag="display_data"):
    """A displayed object, as data by media type."""

    data: Annotated[
        Mapping[Literal["text/plain", "image/png", "image/jpeg"], str], msgspec.Meta(max_length=3)
    ]
    metadata: Annotated[Mapping[str, str], msgspec.Meta(max_length=0)]


class Result(Display, frozen=True, tag="execute_result"):
    """The value of a cell."""

    execution_count: None


class ErrorOutput(_Output, frozen=True, tag="error"):
    """The error that ended a cell."""

    ename: str
    evalue: str
    traceback: Annotated[Sequence[str], msgspec.Meta(max_length=TRACEBACK_LINES)]


class DeskAnswer(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The answer to an order.

    Attributes:
        said: How the order ended.
        outputs: For each cell with new outputs since the last answer, all of its outputs, by the index of the cell.
    """

    number: int
    said: Said
    outputs: Mapping[int, Sequence[Stream | Display | Result | ErrorOutput]]


def admitted_answer(line: bytes, most: int, orders: range, cells: Collection[int]) -> DeskAnswer:
    """Check an answer of the desk, and return it.

    Args:
        line: The line that the desk sent.
        most: The maximum size of the line in bytes.
        orders: The numbers of the orders that wait for an answer.
        cells: The indexes of the cells that were executed.

    Raises:
        NotAdmitted: The line is not an answer to one of these orders.
    """
    answer: DeskAnswer = admitted(line, DeskAnswer, most)
    if answer.number not in orders or not all(cell in cells for cell in answer.outputs):
        raise NotAdmitted("it belongs to another order or cell")
    return answer
