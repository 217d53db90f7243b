"""What the judge's action client has seen of one goal, and what is wrong about it."""

from __future__ import annotations

import statistics
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from autograder.exercises.evidence import Evidence, Part

GOALS = "goals"
BAD_ORDERS = "bad orders"
ORDERS = (5, 4, 3)
"""Orders of the goal alone and of the two at once; the seed decides which is which."""
LAST_ORDER = 2
"""The order of the goal after the bad ones."""
NO_TIME = 0.0005
"""Seconds between two feedback messages that no pause can make: without one they take a tenth of it, and the shortest
that a person would write, a hundredth of a second of which a notebook sleeps a tenth, takes twice as long."""
FIRST_TOO_LARGE = 47
"""The first order whose last number does not fit into an int32."""
ERROR_GOAL_TERMINATED = 3
"""From action_msgs/srv/CancelGoal."""
SUCCEEDED, CANCELED, ABORTED = 4, 5, 6
"""From action_msgs/msg/GoalStatus."""
STATUS = {
    0: "UNKNOWN",
    1: "ACCEPTED",
    2: "EXECUTING",
    3: "CANCELING",
    4: "SUCCEEDED",
    5: "CANCELED",
    6: "ABORTED",
}

ALONE, FIRST_OF_TWO, SECOND_OF_TWO, LONG = range(4)
"""The goals of the first part by their numbers. In the second part the last one is good, those before it are bad."""


@dataclass(frozen=True)
class Goal:
    """What is known of one goal.

    Attributes:
        order: What was asked for; None where the goal was not sent.
        accepted: The server's answer; None where there is none.
        feedback: The partial sequences, in order.
        cancel_accepted: The answer to the cancel request; None where there is none.
        cancelled_too_late: The answer to the cancel request was that the goal had ended.
        before_cancel: How many numbers the last feedback before the cancel request had.
        unread: How many feedback messages came between the cancel request and its answer.
        seconds: Wall time from the acceptance to the result; None where one of them is missing.
        pauses: Seconds between one feedback message and the next, by their publisher's clock.
        status: The status that came with the result; None where none came.
        sequence: The result.
    """

    order: int | None
    accepted: bool | None
    feedback: list[list[int]]
    cancel_accepted: bool | None
    cancelled_too_late: bool
    before_cancel: int
    unread: int
    seconds: float | None
    pauses: tuple[float, ...]
    status: int | None
    sequence: list[int]

    @property
    def over(self) -> bool:
        """It has a result, or it was refused and gets none."""
        return self.status is not None or self.accepted is False


def goal(part: Part, number: int) -> Goal:
    """The goal of that number."""
    events = [event for event in part.events if event.data.get("goal") == number]
    by_kind = {event.kind: event for event in reversed(events)}
    data = {kind: event.data for kind, event in by_kind.items()}
    result = data.get("result_heard", {})
    heard = [event for event in events if event.kind == "feedback_heard"]
    cancel = by_kind.get("cancel_sent")
    split = events.index(cancel) if cancel else len(events)
    answered = events.index(by_kind["cancel_answer"]) if "cancel_answer" in by_kind else len(events)
    before = [event for event in heard if events.index(event) < split]
    sent = [float(event.data["sent"]) for event in heard if "sent" in event.data]
    return Goal(
        order=data.get("goal_sent", {}).get("fields", {}).get("order"),
        accepted=data.get("goal_answer", {}).get("accepted"),
        feedback=[list(event.data["fields"]["partial_sequence"]) for event in heard],
        cancel_accepted=data.get("cancel_answer", {}).get("accepted"),
        cancelled_too_late=data.get("cancel_answer", {}).get("return_code") == ERROR_GOAL_TERMINATED,
        before_cancel=len(before[-1].data["fields"]["partial_sequence"]) if before else 0,
        unread=sum(split < events.index(event) < answered for event in heard),
        seconds=by_kind["result_heard"].t - by_kind["goal_answer"].t if "result_heard" in by_kind else None,
        pauses=tuple(after - before for before, after in pairwise(sent)),
        status=result.get("status"),
        sequence=list(result.get("fields", {}).get("sequence", [])),
    )


def takes_no_time(part: Part) -> bool:
    """Whether the server counts without any pause between two numbers.

    Such a goal is over before anybody can cancel it, except where the machine happens to be so busy that the request
    gets in between. Threads that are in each other's way can hold up a goal or most messages, so it is enough that one
    goal was counted without a pause: a server that pauses does so in every goal.
    """
    pauses = [goal(part, number).pauses for number in (ALONE, FIRST_OF_TWO, SECOND_OF_TWO, LONG)]
    at_once = any(len(one) > 1 and max(one) < NO_TIME for one in pauses)
    return at_once or statistics.median([pause for one in pauses for pause in one] or [NO_TIME]) < NO_TIME


def good_goals(evidence: Evidence) -> list[Goal]:
    """The goals that were to succeed, as far as they were sent."""
    first = [goal(evidence.part(GOALS), number) for number in (ALONE, FIRST_OF_TWO, SECOND_OF_TWO)]
    return [seen for seen in first if seen.order is not None]


def expected_sequence(evidence: Evidence, order: int) -> list[int]:
    """What the reference solution answers to one of the small orders."""
    known = [goal(evidence.reference.part(GOALS), number) for number in (ALONE, FIRST_OF_TWO, SECOND_OF_TWO)]
    longest = max((seen.sequence for seen in known), key=len)
    extra = len(known[0].sequence) - int(known[0].order or 0)
    return longest[: order + extra]


def objection(evidence: Evidence, seen: Goal) -> str:
    """What is wrong about how a good goal ended, in words; empty where it is right."""
    wanted = expected_sequence(evidence, int(seen.order or 0))
    where = f"order {seen.order}: "
    if seen.accepted is None:
        return f"{where}the goal was not answered"
    if not seen.accepted:
        return f"{where}the goal was refused"
    if seen.status is None:
        return f"{where}no result"
    if seen.status != SUCCEEDED:
        return f"{where}status {status_text(seen.status)}"
    return "" if seen.sequence == wanted else f"{where}{seen.sequence}"


def feedback_objection(evidence: Evidence, seen: Goal) -> str:
    """What is wrong about the feedback of a good goal; empty where it grows by one number each time."""
    wanted = expected_sequence(evidence, int(seen.order or 0))
    where = f"order {seen.order}: "
    if not seen.feedback:
        return f"{where}no feedback"
    lengths = [len(partial) for partial in seen.feedback]
    grows = all(after == before + 1 for before, after in pairwise(lengths))
    right = all(partial == wanted[: len(partial)] for partial in seen.feedback)
    # It may begin before or with the first new number, and need not tell the last one, which the result does.
    whole = lengths[0] <= 3 and lengths[-1] >= len(wanted) - 1
    return "" if grows and right and whole else where + ", ".join(map(str, seen.feedback[:4]))


def status_text(number: int | None) -> str:
    """A goal's status by name and number."""
    return "none" if number is None else f"{STATUS.get(number, '?')} ({number})"


def is_beginning(numbers: Sequence[int], start: Sequence[int]) -> bool:
    """Whether the numbers go on from ``start`` as the sequence does."""
    return list(numbers[:2]) == list(start[: len(numbers[:2])]) and all(
        c == a + b for a, b, c in zip(numbers, numbers[1:], numbers[2:], strict=False)
    )


def first_two(evidence: Evidence) -> list[int]:
    """What the sequence begins with."""
    return expected_sequence(evidence, min(ORDERS))[:2]


def all_goals(part: Part) -> list[Goal]:
    """All goals that were sent."""
    return [goal(part, int(event.data["goal"])) for event in part.of("goal_sent")]
