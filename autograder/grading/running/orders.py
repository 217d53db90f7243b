"""Messages between the dispatcher and the machines that execute tasks; and the offer of a machine.

For a cluster, they are lines of JSON to the client process; for this machine, plain objects. Orders and answers are
bytes, which the client process never decodes.
"""

from __future__ import annotations

import msgspec

ADDRESS = "this machine"
"""The address of the worker that is this machine. This worker is never rejected: otherwise nothing could be graded."""
JUDGE = "autograder.judge.serving.process:JudgeProcess"
"""The class of the real judge, as ``module:class``. It is named, not imported: only workers load a judge."""


class Offer(msgspec.Struct, frozen=True):
    """What a worker says about itself before it gets work.

    Attributes:
        version: The version of the worker's course
            (:func:`autograder.grading.rebuilding.course_version.course_version`).
        slots: The number of notebooks that it executes at the same time.
        obstacle: Why it cannot execute in sandboxes, and what to do; empty if it can.
    """

    version: str
    slots: int
    obstacle: str


class Order(msgspec.Struct, frozen=True):
    """An order to a worker: execute this task.

    Attributes:
        task: The task, as JSON.
        judge: The class of the judge, as ``module:class``.
    """

    task: msgspec.Raw
    judge: str


class Give(msgspec.Struct, frozen=True, tag=True):
    """A command to the connection: have this worker execute this order.

    Attributes:
        number: A number that identifies the order in the answer.
        worker: The address of the worker.
        order: An :class:`Order` as JSON.
    """

    number: int
    worker: str
    order: bytes


class Drop(msgspec.Struct, frozen=True, tag=True):
    """A command to the connection: the answer to this order is no longer needed."""

    number: int


class Joined(msgspec.Struct, frozen=True, tag=True):
    """A message: a worker exists, and has sent something that should be an :class:`Offer`."""

    worker: str
    name: str
    offer: bytes


class Unfit(msgspec.Struct, frozen=True, tag=True):
    """A message: a worker exists, but has sent no offer."""

    worker: str
    name: str
    reason: str


class Asked(msgspec.Struct, frozen=True, tag=True):
    """A message: every worker that existed at the beginning has been asked for its offer."""


class Left(msgspec.Struct, frozen=True, tag=True):
    """A message: a worker has ended, and the reason if it is known."""

    worker: str
    reason: str = ""


class Answered(msgspec.Struct, frozen=True, tag=True):
    """A message: a worker's answer, which should be an execution as JSON. It has not been checked yet."""

    number: int
    data: bytes


class Failed(msgspec.Struct, frozen=True, tag=True):
    """A message: there is no answer to an order.

    Attributes:
        number: The number of the order.
        reason: Why there is no answer.
        forged: True if the worker's answer was one that an unmodified worker would never send.
    """

    number: int
    reason: str
    forged: bool = False


class Broken(msgspec.Struct, frozen=True, tag=True):
    """A message: no worker can be reached any more. No message follows this one."""

    reason: str


Command = Give | Drop
News = Joined | Unfit | Asked | Left | Answered | Failed | Broken

LARGEST_ANSWER = 16_000_000
"""The maximum size of an answer in bytes. A notebook's outputs are cut at 2 MB, and its evidence at 4 MB, which is a
third more as JSON.
"""
