"""Reads from the evidence what happened to each goal that the judge's action client sent to the subject's server."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Mapping

    from autograder.kit.evidence import Part

ERROR_GOAL_TERMINATED = 3
"""The return code of action_msgs/srv/CancelGoal for a goal that has already ended."""
SUCCEEDED, CANCELED, ABORTED = 4, 5, 6
"""The numbers of three statuses, as defined in action_msgs/msg/GoalStatus."""
STATUS = {
    0: "UNKNOWN",
    1: "ACCEPTED",
    2: "EXECUTING",
    3: "CANCELING",
    4: "SUCCEEDED",
    5: "CANCELED",
    6: "ABORTED",
}


@dataclass(frozen=True)
class Goal:
    """A goal that the judge sent, with everything that the subject's server answered.

    Attributes:
        request: The fields of the goal; None if the goal was not sent.
        accepted: True if the server accepted the goal, False if it refused; None if it did not answer.
        feedback: The fields of each feedback message that was sent before the judge had the result, in order.
        sent: For each message in ``feedback``, when it was sent, in seconds since the epoch by the publisher's clock.
        answered_at: When the server's answer to the goal arrived, by the judge's clock; None if unknown.
        cancel_answered_at: When the answer to the cancel request arrived, by the judge's clock; None if unknown.
        cancel_accepted: True if the server accepted the cancel request; None if it did not answer or none was sent.
        cancelled_too_late: True if the server answered the cancel request by saying that the goal had already ended.
        before_cancel: The number of feedback messages that arrived before the cancel request was sent.
        unread: The number of feedback messages that arrived between the cancel request and its answer.
        seconds: Wall time in seconds from the acceptance to the result; None if one of them is missing.
        status: The status that came with the result; None if no result came.
        result: The fields of the result; empty if no result came.
    """

    request: Mapping[str, Any] | None
    accepted: bool | None
    feedback: list[Mapping[str, Any]]
    sent: tuple[float, ...]
    answered_at: float | None
    cancel_answered_at: float | None
    cancel_accepted: bool | None
    cancelled_too_late: bool
    before_cancel: int
    unread: int
    seconds: float | None
    status: int | None
    result: Mapping[str, Any]

    @property
    def over(self) -> bool:
        """True if the goal has a result, or was refused and therefore gets none."""
        return self.status is not None or self.accepted is False

    @property
    def pauses(self) -> tuple[float, ...]:
        """The times between successive feedback messages, in seconds."""
        return tuple(after - before for before, after in pairwise(self.sent))

    def sent_after(self, moment: float | None) -> int:
        """Return how many feedback messages were certainly sent after a moment; 0 if the moment is unknown."""
        return 0 if moment is None else sum(sent > moment for sent in self.sent)


def goal(part: Part, number: int) -> Goal:
    """Return the goal with a given number; the judge numbers its goals from 0."""
    events = [event for event in part.events if event.data.get("goal") == number]
    first = {event.kind: place for place, event in reversed(list(enumerate(events)))}
    by_kind = {kind: events[place] for kind, place in first.items()}
    data = {kind: event.data for kind, event in by_kind.items()}
    result = data.get("result_heard", {})
    ended_at = result.get("arrived", math.inf)
    places = [
        i for i, e in enumerate(events) if e.kind == "feedback_heard" and e.data.get("sent", 0.0) <= ended_at
    ]
    heard = [events[place] for place in places]
    split = first.get("cancel_sent", len(events))
    answered = first.get("cancel_answer", len(events))
    return Goal(
        request=data.get("goal_sent", {}).get("fields"),
        accepted=data.get("goal_answer", {}).get("accepted"),
        feedback=[event.data["fields"] for event in heard],
        sent=tuple(float(event.data["sent"]) for event in heard if "sent" in event.data),
        answered_at=data.get("goal_answer", {}).get("arrived"),
        cancel_answered_at=data.get("cancel_answer", {}).get("arrived"),
        cancel_accepted=data.get("cancel_answer", {}).get("accepted"),
        cancelled_too_late=data.get("cancel_answer", {}).get("return_code") == ERROR_GOAL_TERMINATED,
        before_cancel=sum(place < split for place in places),
        unread=sum(split < place < answered for place in places),
        seconds=by_kind["result_heard"].t - by_kind["goal_answer"].t if "result_heard" in by_kind else None,
        status=result.get("status"),
        result=result.get("fields", {}),
    )


def all_goals(part: Part) -> list[Goal]:
    """Return all goals that the judge sent in a part."""
    return [goal(part, int(event.data["goal"])) for event in part.of("goal_sent")]


def status_text(number: int | None) -> str:
    """Return a goal's status as text, such as ``SUCCEEDED (4)``."""
    return "none" if number is None else f"{STATUS.get(number, '?')} ({number})"
