"""The runs of Exercise 1.3 as they show a client: its goal, when it asked to cancel, what it said of the end."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from autograder.kit.goal_reports import CANCELED, REFUSED, SUCCEEDED, WAS_ABORTED, asked_for, left_at_once

if TYPE_CHECKING:
    from autograder.kit.evidence import Event, Evidence, Part
    from autograder.kit.outcomes import Outcome

HONOURED = "the server cancels"
CANCEL_REFUSED = "the server refuses to cancel"
AGREED = "the server agrees to cancel, and then fails"

OUTCOMES = {"canceled": CANCELED, "succeeded": SUCCEEDED, "aborted": WAS_ABORTED}
"""What a client has to report of a goal, by the goal's end."""

FIRST_FEEDBACK, LAST_FEEDBACK = 3, 5
"""The cancel request must come after this many feedback messages, at the earliest and at the latest."""

LEFT = "it asked, and ended without waiting for what came of it"


@dataclass(frozen=True)
class Request:
    """A request to cancel.

    Attributes:
        count: How many feedback messages were sent before it.
        after: Seconds of wall time from the answer to the goal to it.
        asked_for_result: Whether the result was asked for, too, sooner or later.
    """

    count: int
    after: float
    asked_for_result: bool


def goals(part: Part) -> list[Event]:
    """The goals that were sent."""
    return part.of("goal")


def expected_order(evidence: Evidence) -> int:
    """The order that the reference solution asks for."""
    return int(goals(evidence.reference.part(HONOURED))[0].data["fields"]["order"])


def feedbacks_before_cancel(part: Part) -> int | None:
    """The number of feedback messages sent before the first cancel request; None where none came."""
    cancel = part.first("cancel")
    if cancel is None:
        return None
    before = part.events[: part.events.index(cancel)]
    return sum(event.kind == "feedback" for event in before)


def in_the_window(part: Part) -> bool:
    """True if the first request to cancel came after as many feedback messages as the task asks for."""
    count = feedbacks_before_cancel(part)
    return count is not None and FIRST_FEEDBACK <= count <= LAST_FEEDBACK


def was_asked_at_once(part: Part, seconds: float) -> bool:
    """True if the first request to cancel came at most so many seconds after the last feedback before it."""
    cancel = part.first("cancel")
    before = part.of("feedback")[: feedbacks_before_cancel(part)]
    return cancel is not None and bool(before) and cancel.t - before[-1].t <= seconds


def request_of(part: Part) -> Request | None:
    """The first request to cancel; None where none came."""
    answered, cancel, count = part.first("goal_answered"), part.first("cancel"), feedbacks_before_cancel(part)
    if answered is None or cancel is None or count is None:
        return None
    return Request(count, cancel.t - answered.t, part.first("result_request") is not None)


def left_before_its_answer(part: Part) -> bool:
    """True if the client asked to cancel, and ended without having waited for anything that comes of it.

    Whether its request still arrives, and whether its process is gone before the answer comes, is chance.
    """
    return part.first("cancel") is not None and left_at_once(part, "cancel_answered")


def telling_count(evidence: Evidence) -> int | None:
    """Return the number of feedback messages before the cancel request, in the run in which it is most wrong."""
    runs = (evidence.part(HONOURED), evidence.part(CANCEL_REFUSED))
    counts = [feedbacks_before_cancel(part) for part in runs if goals(part)] or [None]
    return next((n for n in counts if n is None or not FIRST_FEEDBACK <= n <= LAST_FEEDBACK), counts[0])


def after_result(part: Part) -> list[str]:
    """The lines that were said after the result."""
    result = part.first("result")
    return part.said(after=result) if result else []


def unreported_end(evidence: Evidence) -> tuple[Outcome, Part, list[Part]] | None:
    """The first goal whose end is not reported: how it ended, its run, and the runs that ended otherwise."""
    ends = {part.name: end.data["status"] for part in evidence if (end := part.first("result"))}
    for name in (HONOURED, CANCEL_REFUSED, AGREED):
        outcome, part = OUTCOMES.get(ends.get(name, "")), evidence.part(name)
        others = [other for other in evidence if ends.get(other.name) != ends.get(name)]
        if outcome is not None and outcome.missing(part, others):
            return outcome, part, others
    return None


def asks_again_when_refused(evidence: Evidence) -> bool:
    """True if it requests once if its cancel is accepted, and several times if it is refused."""
    return len(evidence.main.of("cancel")) == 1 and len(evidence.part(CANCEL_REFUSED).of("cancel")) > 1


def cancels_every_goal(evidence: Evidence) -> bool:
    """True if its request has no goal's id: then it asks for every goal of the server (action_msgs/srv/CancelGoal)."""
    cancel = evidence.main.first("cancel")
    return cancel is not None and bool(cancel.data.get("every"))


def orders_as_seen(evidence: Evidence) -> str:
    """Return the fault of the goals that it sent, in words; empty if each run has one of the right order."""
    made = asked_for(evidence.main)
    refused = asked_for(evidence.part(REFUSED))
    if len(made) > 1:
        return f"{len(made)} goals"
    if made and made[0] != expected_order(evidence):
        return f"order {made[0]}"
    return f"{len(refused)} goals, as the first was rejected" if made and len(refused) > 1 else ""
