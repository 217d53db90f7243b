"""Commands and messages between the dispatcher and its workers.

They are sent as lines of JSON, to and from the executor process of this machine or the client process of a cluster. The
client process only passes orders and answers on as bytes, without decoding them.
"""

from __future__ import annotations

import msgspec

ADDRESS = "this machine"
"""The address of the worker that is this machine. Its version of the course is not compared, because the grader uses
the same course.
"""
JUDGE = "autograder.judge.serving.process:JudgeProcess"
"""The name of the real judge's Python class, as ``module:class``; only workers import the class itself."""


class Offer(msgspec.Struct, frozen=True):
    """What a worker says about itself before it gets work.

    Attributes:
        version: The version of the worker's course
            (:func:`autograder.grading.rebuilding.course_version.course_version`).
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
        number: The number of the order.
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
