"""The messages between the grader and its client process, one line of JSON each, and a worker's offer.

Orders and answers are bytes to the client process: it carries them and never looks inside.
"""

from __future__ import annotations

import msgspec


class Offer(msgspec.Struct, frozen=True):
    """A worker's description of itself before it gets work.

    Attributes:
        version: Stands for the course, as :func:`autograder.grading.rebuilding.course_version.course_version` has it.
        slots: Notebooks that it executes at once.
        obstacle: Why it cannot execute in boxes, and what to do; empty where it can.
    """

    version: str
    slots: int
    obstacle: str


class Order(msgspec.Struct, frozen=True):
    """An order to a worker.

    Attributes:
        task: The task, as JSON.
        judge: What makes a judge, as ``module:class``.
    """

    task: msgspec.Raw
    judge: str


class Give(msgspec.Struct, frozen=True, tag=True):
    """To the client process: have this worker execute this order.

    Attributes:
        number: Names the order in what comes back.
        worker: The worker's address.
        order: An :class:`Order` as JSON.
    """

    number: int
    worker: str
    order: bytes


class Drop(msgspec.Struct, frozen=True, tag=True):
    """To the client process: nobody waits for this order any more."""

    number: int


class Joined(msgspec.Struct, frozen=True, tag=True):
    """A worker is there and has said something that should be an :class:`Offer`."""

    worker: str
    name: str
    offer: bytes


class Unfit(msgspec.Struct, frozen=True, tag=True):
    """A worker is there but could not say what it offers."""

    worker: str
    name: str
    reason: str


class Asked(msgspec.Struct, frozen=True, tag=True):
    """Every worker that was there at the beginning was asked."""


class Left(msgspec.Struct, frozen=True, tag=True):
    """A worker is gone."""

    worker: str


class Answered(msgspec.Struct, frozen=True, tag=True):
    """A worker's answer, which should be an execution as JSON; nobody has looked at it yet."""

    number: int
    data: bytes


class Failed(msgspec.Struct, frozen=True, tag=True):
    """An order brought no answer.

    Attributes:
        number: The order.
        reason: Why.
        forged: Whether the worker answered something that no worker of ours would.
    """

    number: int
    reason: str
    forged: bool = False


class Broken(msgspec.Struct, frozen=True, tag=True):
    """The scheduler cannot be reached (any more). The client process ends after it."""

    reason: str


Command = Give | Drop
News = Joined | Unfit | Asked | Left | Answered | Failed | Broken

LARGEST_ANSWER = 16_000_000
"""Bytes. A notebook's outputs are cut at 2 MB, and what its judge saw at 4 MB, a third more as JSON."""
