"""Commands and messages between the dispatcher and its workers, and the check of a worker's answer.

They are sent as lines of JSON, to and from the executor process of this machine or the client process of a cluster. The
client process only passes orders and answers on as bytes, without decoding them.

A student's program may have taken over the worker that executed it. So the dispatcher checks each answer before it uses
the answer (:func:`admitted_execution`): it must have the form of an execution of the task, and no check in it may give
more than the check's maximum points. Everything that a browser would run is removed from the outputs.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import msgspec

from autograder.boxes.admission import NotAdmitted, admitted
from autograder.cards.readable_text import paragraph
from autograder.execution.executed_cells import Execution, NotebookOutputs
from autograder.verdict import State

if TYPE_CHECKING:
    from autograder.execution.executed_cells import CellCheck
    from autograder.grading.grading_task import Task
    from autograder.verdict import Verdict


ADDRESS = "this machine"
"""The address of the worker that is this machine. Its version of the course is not compared, because the grader uses
the same course.
"""
JUDGE = "autograder.judge.controlled_judge:JudgeProcess"
"""The name of the real judge's Python class, as ``module:class``; only workers import the class itself."""


class Offer(msgspec.Struct, frozen=True):
    """What a worker says about itself before it gets work.

    Attributes:
        version: The version of the worker's course
            (:func:`autograder.grading.course_version.course_version`).
        slots: The number of notebooks that the worker executes at the same time.
        obstacle: Why the worker cannot make sandboxes, and what to do; empty if it can.
    """

    version: str
    slots: int
    obstacle: str


class Order(msgspec.Struct, frozen=True):
    """An order to a worker to execute a task.

    Attributes:
        task: The task, as JSON.
        judge: The Python class of the judge, as ``module:class``.
    """

    task: msgspec.Raw
    judge: str


class Give(msgspec.Struct, frozen=True, tag=True):
    """A command: pass this order to this worker.

    Attributes:
        number: A number that identifies the order in the answer.
        worker: The address of the worker.
        order: An :class:`Order` as JSON.
    """

    number: int
    worker: str
    order: bytes


class Drop(msgspec.Struct, frozen=True, tag=True):
    """A command: cancel this order, because its answer is no longer needed."""

    number: int


class Joined(msgspec.Struct, frozen=True, tag=True):
    """A message: a worker has joined. ``offer`` should be an :class:`Offer` as JSON, but has not been checked yet."""

    worker: str
    name: str
    offer: bytes


class Unfit(msgspec.Struct, frozen=True, tag=True):
    """A message: a worker has joined, but has sent no offer. ``reason`` says why."""

    worker: str
    name: str
    reason: str


class Asked(msgspec.Struct, frozen=True, tag=True):
    """A message: all workers that existed at the beginning have been reported, with or without an offer."""


class Left(msgspec.Struct, frozen=True, tag=True):
    """A message: a worker has ended. ``reason`` is empty if it is not known."""

    worker: str
    reason: str = ""


class Answered(msgspec.Struct, frozen=True, tag=True):
    """A message: a worker's answer to an order. ``data`` should be an execution as JSON, but is not checked yet."""

    number: int
    data: bytes


class Failed(msgspec.Struct, frozen=True, tag=True):
    """A message: an order will get no answer.

    Attributes:
        reason: Why no answer will come.
        forged: True if the worker sent an answer that an unmodified worker would never send.
    """

    number: int
    reason: str
    forged: bool = False


class Broken(msgspec.Struct, frozen=True, tag=True):
    """A message, always the last: the connection to all workers is lost."""

    reason: str


Command = Give | Drop
News = Joined | Unfit | Asked | Left | Answered | Failed | Broken

LARGEST_ANSWER = 16_000_000
"""The maximum size of an answer in bytes. An answer contains at most 2 MB of outputs and 4 MB of evidence; as JSON, the
evidence takes a third more.
"""

LARGEST_OFFER = 4_000
_MOST_SLOTS = 1_000
LONGEST_WORDS = 1_000
"""The maximum length in characters of a sentence from a worker."""


def admitted_offer(data: bytes) -> Offer:
    """Decode and check a worker's offer, and return it.

    Raises:
        NotAdmitted: The data is not a valid offer.
    """
    offer: Offer = admitted(data, Offer, LARGEST_OFFER)
    if not 1 <= offer.slots <= _MOST_SLOTS:
        raise NotAdmitted(f"it offers to execute {offer.slots} notebooks at the same time")
    return offer


def admitted_execution(data: bytes, task: Task) -> Execution:
    """Decode and check a worker's answer to a task, and return the execution with cleaned outputs.

    Raises:
        NotAdmitted: The data is not an execution, or not an execution of this task.
    """
    execution: Execution = admitted(data, Execution, LARGEST_ANSWER)
    if len(execution.cells) not in ({len(task.cells), 0} if execution.trouble else {len(task.cells)}):
        raise NotAdmitted(f"it has {len(execution.cells)} cells, and the notebook has {len(task.cells)}")
    checks = task.checks
    if execution.verdicts.keys() != checks.keys():
        raise NotAdmitted("it has verdicts on other checks than the notebook has")
    for index, check in checks.items():
        _look_at(execution.verdicts[index], check)
    # Cut and clean the outputs again: the worker should have done so, but is not trusted.
    outputs = NotebookOutputs(
        len(execution.cells), task.limits.cell_output_bytes, task.limits.notebook_output_bytes
    )
    for index, cell in enumerate(execution.cells):
        outputs.put(index, cell.outputs)
    cells = tuple(
        replace(cell, outputs=outputs.of(index), error=cell.error[:500])
        for index, cell in enumerate(execution.cells)
    )
    return replace(execution, cells=cells, trouble=paragraph(execution.trouble, LONGEST_WORDS))


def _look_at(verdict: Verdict, check: CellCheck) -> None:
    if verdict.exercise != check.exercise:
        raise NotAdmitted(f"it has a verdict on {verdict.exercise!r:.60} instead of {check.exercise}")
    if verdict.max_score != check.points or not 0 <= verdict.score <= check.points:
        raise NotAdmitted(f"it gives {verdict.score:g} of {verdict.max_score:g} points for {check.exercise}")
    if verdict.state is State.NOT_CHECKED and verdict.score:
        raise NotAdmitted("it gives points for an exercise that could not be checked")
