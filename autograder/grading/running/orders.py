"""Define the messages between the dispatcher and the machines that execute tasks, and a machine's offer.

For a cluster they are lines of JSON to the client process, for this machine plain objects. Orders and answers are
bytes, which the client process never decodes.
"""

from __future__ import annotations

import msgspec

ADDRESS = "this machine"
"""The address of the worker that is this machine. It is never refused: then nothing could be graded."""
JUDGE = "autograder.judge.serving.process:JudgeProcess"
"""The class of the real judge, as ``module:class``. It is named, not imported: only workers load a judge."""


class Offer(msgspec.Struct, frozen=True):
    """A worker's description of itself before it gets work.

    Attributes:
        version: The version of its course (:func:`autograder.grading.rebuilding.course_version.course_version`).
        slots: The number of notebooks that it executes at once.
        obstacle: Why it cannot execute in sandboxes, and what to do; empty if it can.
    """

    version: str
    slots: int
    obstacle: str


class Order(msgspec.Struct, frozen=True):
    """An order to a worker.

    Attributes:
        task: The task, as JSON.
        judge: The class of the judge, as ``module:class``.
    """

    task: msgspec.Raw
    judge: str


class Give(msgspec.Struct, frozen=True, tag=True):
    """A command: have this worker execute this order.

    Attributes:
        number: Identifies the order in the answer.
        worker: The worker's address.
        order: An :class:`Order` as JSON.
    """

    number: int
    worker: str
    order: bytes


class Drop(msgspec.Struct, frozen=True, tag=True):
    """A command: the answer to this order is no longer needed."""

    number: int


class Joined(msgspec.Struct, frozen=True, tag=True):
    """A worker exists and has sent something that should be an :class:`Offer`."""

    worker: str
    name: str
    offer: bytes


class Unfit(msgspec.Struct, frozen=True, tag=True):
    """A worker exists but has sent no offer."""

    worker: str
    name: str
    reason: str


class Asked(msgspec.Struct, frozen=True, tag=True):
    """Every worker that existed at the beginning has been asked."""


class Left(msgspec.Struct, frozen=True, tag=True):
    """A worker has ended."""

    worker: str


class Answered(msgspec.Struct, frozen=True, tag=True):
    """A worker's answer, which should be an execution as JSON; it has not been checked."""

    number: int
    data: bytes


class Failed(msgspec.Struct, frozen=True, tag=True):
    """An order brought no answer.

    Attributes:
        number: The number of the order.
        reason: The reason.
        forged: True if the worker has answered something that no worker of ours would.
    """

    number: int
    reason: str
    forged: bool = False


class Broken(msgspec.Struct, frozen=True, tag=True):
    """No worker can be reached any more. No message follows."""

    reason: str


Command = Give | Drop
News = Joined | Unfit | Asked | Left | Answered | Failed | Broken

LARGEST_ANSWER = 16_000_000
"""Limit of an answer in bytes. A notebook's outputs are cut at 2 MB, and its evidence at 4 MB, a third more as JSON."""
