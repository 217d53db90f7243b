"""The interfaces of the publishers, servers and clients that the judge makes in a scenario.

A field of floats also takes whole numbers. Each method that is given fields raises a ValueError if the type has no such
field or the field cannot hold the value; an answer of a server that does not fit raises it when the part ends.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum
from math import isfinite
from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence


class Qos(StrEnum):
    """The quality of service of a publisher or subscription, named after the profile that gives it."""

    DEFAULT = "default"
    """Reliable and volatile: the queue depth 10."""
    SENSOR = "sensor"
    """Best effort, like rclpy's ``qos_profile_sensor_data``: a reliable subscription does not match the publisher."""
    LATCHED = "latched"
    """Transient local: a late subscription gets the last message. A volatile publisher does not match it."""


class Speaker(Protocol):
    """A publisher of the judge."""

    def send(self, **fields: Any) -> None:
        """Publish one message with these fields."""


class Server(Protocol):
    """A service server of the judge."""

    def release(self) -> None:
        """Send the answer that the server has held back."""

    def close(self) -> None:
        """Remove the service."""


@dataclass(frozen=True)
class Work:
    """The behavior of the judge with a goal that the subject sends to an action of the judge.

    Attributes:
        status: How the goal ends: ``"succeeded"``, ``"aborted"``, or ``"rejected"``, which it is at once. A goal that
            is canceled before its end ends ``"canceled"``.
        takes: Seconds of the subject's time until the end; ``inf`` for a goal that runs until it is canceled.
        feedback: The fields of the feedback messages, which are spread evenly over that time; with a goal that does
            not end, one each second.
        result: The fields of the result.
    """

    status: str = "succeeded"
    takes: float = 0.3
    feedback: Sequence[Mapping[str, Any]] = ()
    result: Mapping[str, Any] = field(default_factory=dict)

    @property
    def accepts(self) -> bool:
        """True if the goal is accepted."""
        return self.status != "rejected"

    @property
    def between(self) -> float:
        """The seconds between two feedback messages."""
        return self.takes / (len(self.feedback) + 1) if isfinite(self.takes) else 1.0

    def told_after(self, seconds: float) -> int:
        """Return how many feedback messages are due so many seconds after the goal was accepted."""
        return int((seconds + SOON) / self.between)


SOON = 1e-6
"""Seconds that do not count, because clocks round."""


class ActionCounterpart(Protocol):
    """An action server of the judge that does only what the scenario tells it to."""

    def await_goal(self, within: float) -> bool:
        """Wait until a goal has arrived and been answered; False if none came in ``within`` seconds."""

    def send_feedback(self, **fields: Any) -> None:
        """Send one feedback message for the current goal."""

    def say_status(self) -> None:
        """Publish the current goal's status (executing), as a server does when it begins to execute a goal."""

    def await_cancel(self, within: float) -> bool:
        """Wait for a request to cancel the current goal; False if none came in ``within`` seconds."""

    def await_result_request(self, within: float) -> bool:
        """Wait until the subject requests the result."""

    def finish(self, status: str, **fields: Any) -> None:
        """End the goal with ``"succeeded"``, ``"canceled"`` or ``"aborted"`` and this result."""


class Caller(Protocol):
    """A client with which the judge calls one service. Its calls are numbered from 0.

    It records these events: ``servers`` (how many servers of this name exist), ``asked`` and ``answered``.
    """

    def await_server(self, within: float) -> bool:
        """Wait until the client can call; False if no server of the name and type appears in ``within`` seconds."""

    def ask(self, *requests: Mapping[str, Any]) -> None:
        """Send requests, one right after the other, without waiting for answers."""

    def await_answers(self, quiet: float) -> bool:
        """Wait until every call is answered; False if no event at all was recorded for ``quiet`` seconds."""


class ActionCaller(Protocol):
    """A client with which the judge sends goals to one action. Its goals are numbered from 0.

    It records the events ``servers``, ``goal_sent``, ``goal_answer``, ``feedback_heard``, ``cancel_sent``,
    ``cancel_answer``, ``goal_ended`` and ``result_heard``. All but ``servers`` contain the number of the goal.
    """

    def await_server(self, within: float) -> bool:
        """Wait until the client can send goals; False if no matching server appears in ``within`` seconds."""

    def send_goal(self, number: int | None = None, /, **fields: Any) -> int:
        """Send a goal, and request the result once the goal is accepted. Return the number of the goal.

        The number of an earlier goal must not be given again; by default goals are counted from 0.
        """

    def cancel(self, goal: int) -> None:
        """Request to cancel a goal."""
