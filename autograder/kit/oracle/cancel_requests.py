"""What a run shows of a client that asks to cancel its goal: when it asked, and how it reported the goal's end."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import dropwhile, takewhile
from typing import TYPE_CHECKING

from autograder.kit.goal_reports import CANCELED, SUCCEEDED, WAS_ABORTED, left_at_once

if TYPE_CHECKING:
    from autograder.kit.evidence import Event, Evidence, Part
    from autograder.kit.outcomes import Outcome

HONORED = "the server cancels"
CANCEL_REFUSED = "the server refuses to cancel"
AGREED = "the server agrees to cancel, and then fails"
"""The names of the runs in which the goal is accepted; in each, it ends in another way."""
OUTCOMES = {"canceled": CANCELED, "succeeded": SUCCEEDED, "aborted": WAS_ABORTED}
"""The outcome that a client has to report, by the end of its goal."""
LEFT = "it asked, and ended without waiting for what came of it"


@dataclass(frozen=True)
class CancelRequest:
    """The first request of a run to cancel the goal.

    Attributes:
        count: The number of feedback messages that were sent before it.
        since_goal: Seconds of wall time from the answer to the goal to the request.
        since_feedback: The same from the last feedback message before it; infinite if there was none.
    """

    count: int
    since_goal: float
    since_feedback: float


def cancel_request(part: Part) -> CancelRequest | None:
    """Return the first request to cancel; None if none came."""
    cancel = part.first("cancel")
    if cancel is None:
        return None
    before = part.events[: part.events.index(cancel)]
    last = {event.kind: event.t for event in before}
    feedbacks = sum(event.kind == "feedback" for event in before)
    since_feedback = cancel.t - last.get("feedback", -float("inf"))
    return CancelRequest(feedbacks, cancel.t - last.get("goal_answered", cancel.t), since_feedback)


def no_cancel(part: Part) -> str:
    """Return in words why a run shows no request to cancel; empty if it shows one.

    If a client ended without waiting for anything that comes of its request, chance decides whether the request
    arrives, so it does not count.
    """
    if part.first("cancel") is None:
        return "no cancel request"
    return LEFT if left_at_once(part, "cancel_answered") else ""


def requests_at_that_moment(part: Part) -> tuple[int, list[Event]]:
    """Return the number of requests to cancel before more feedback arrived, and all events from this feedback on."""
    from_request = list(dropwhile(lambda event: event.kind != "cancel", part.events))
    at_once = list(takewhile(lambda event: event.kind != "feedback", from_request))
    return sum(event.kind == "cancel" for event in at_once), list(from_request[len(at_once) :])


def after_result(part: Part) -> list[str]:
    """Return the lines that the client said after its result."""
    result = part.first("result")
    return part.said(after=result) if result else []


def unreported_end(evidence: Evidence) -> tuple[Outcome, Part, list[Part]] | None:
    """Return the first goal whose end is not reported: its outcome, its run, and the runs that ended otherwise."""
    ends = {part.name: end.data["status"] for part in evidence if (end := part.first("result"))}
    for name in (HONORED, CANCEL_REFUSED, AGREED):
        outcome, part = OUTCOMES.get(ends.get(name, "")), evidence.part(name)
        others = [other for other in evidence if ends.get(other.name) != ends.get(name)]
        if outcome is not None and outcome.missing(part, others):
            return outcome, part, others
    return None
