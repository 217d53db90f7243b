"""Exercise 1.3: a client that cancels its goal after a few feedback messages and reports how the goal ended."""

from __future__ import annotations

from typing import TYPE_CHECKING

from exercise_1_3._cancel_evidence import (
    CANCEL_REFUSED,
    FIRST_FEEDBACK,
    HONOURED,
    LAST_FEEDBACK,
    LEFT,
    after_result,
    asks_again_when_refused,
    cancels_every_goal,
    expected_order,
    left_before_its_answer,
    orders_as_seen,
    telling_count,
    unreported_end,
)
from exercise_1_3._cancel_mistakes import MISTAKES
from exercise_1_3._cancel_scenario import scenario

from autograder.kit.draft import Draft
from autograder.kit.goal_reports import MANY_REQUESTS, NOT_AWAITED, asked_for, left_at_once, tells_of_refusal
from autograder.kit.in_words import counted
from autograder.kit.model import Finding
from autograder.kit.recipes.action_client import ActionClient

if TYPE_CHECKING:
    from autograder.kit.evidence import Event, Evidence, Part


def sends_the_goal(evidence: Evidence) -> Finding:
    """Exactly one goal of the reference's order."""
    wanted = expected_order(evidence)
    made = asked_for(evidence.main)
    if made and left_at_once(evidence.main):
        return Finding(False, f"one goal of order {wanted}", NOT_AWAITED)
    wrong = orders_as_seen(evidence) if made else "no goal"
    return Finding(not wrong, f"one goal of order {wanted}", wrong or f"order {wanted}")


def cancels_in_the_window(evidence: Evidence) -> Finding:
    """The first cancel request comes after 3 to 5 feedback messages."""
    count = telling_count(evidence)
    expected = f"after {FIRST_FEEDBACK} to {LAST_FEEDBACK} feedback messages"
    seen = "no cancel request" if count is None else f"after {counted(count, 'feedback message')}"
    inside = count is not None and FIRST_FEEDBACK <= count <= LAST_FEEDBACK
    if count is not None and left_before_its_answer(evidence.main):
        return Finding(False, expected, LEFT)
    if cancels_every_goal(evidence):
        return Finding(False, expected, "a request to cancel every goal of the server")
    # With two goals it is unclear whose feedback the client counts. A single goal may have any order here.
    goals = len(evidence.main.of("goal"))
    return Finding(inside and goals == 1, expected, seen if goals < 2 else f"{seen}, with {goals} goals sent")


def cancels_once(evidence: Evidence) -> Finding:
    """There is no second cancel request before late feedback arrives, and none if the first is refused."""
    cancels = _cancels(evidence.main)
    expected = "one cancel request, before more feedback arrives"
    if cancels and left_before_its_answer(evidence.main):
        return Finding(False, expected, LEFT)
    if asks_again_when_refused(evidence):
        total = len(evidence.part(CANCEL_REFUSED).of("cancel"))
        return Finding(False, expected, f"{total} cancel requests where the server refuses")
    seen = f"{len(cancels)} cancel request{'s' * (len(cancels) != 1)}, before more feedback arrived"
    return Finding(len(cancels) == 1, expected, seen if cancels else "no cancel request")


def ignores_late_feedback(evidence: Evidence) -> Finding:
    """Feedback that arrives after the request causes no further request and no new goal.

    A client that requests again before any arrives uses a clock: chance decides whether it ticks during late
    feedback, and :func:`cancels_once` judges that.
    """
    part = evidence.main
    expected = "nothing more is asked for"
    first = part.first("cancel")
    if first is None:
        return Finding(False, expected, "no cancel request")
    if left_before_its_answer(part):
        return Finding(False, expected, LEFT)
    later = part.events[part.events.index(first) + 1 :]
    arrived = next((place for place, event in enumerate(later) if event.kind == "feedback"), len(later))
    kinds = ("cancel", "goal") if len(_cancels(part)) == 1 else ("goal",)
    acted = [event for event in later[arrived:] if event.kind in kinds]
    seen = f"{len(acted)} more {acted[0].kind} requests" if acted else expected
    return Finding(not acted, expected, seen)


def _cancels(part: Part) -> list[Event]:
    """The cancel requests, those that late feedback caused aside."""
    first = part.first("cancel")
    if first is None:
        return []
    found = [first]
    for event in part.events[part.events.index(first) + 1 :]:
        if event.kind == "feedback":
            break
        if event.kind == "cancel":
            found.append(event)
    return found


def reports_the_status(evidence: Evidence) -> Finding:
    """The client says of each goal how it ended."""
    expected = "says `canceled`, `succeeded` or `aborted`, or `status` and the number, as each goal ended"
    part = evidence.part(HONOURED)
    if part.first("cancel") is None:
        return Finding(False, expected, "no cancel request")
    if (asked := len(part.of("result_request"))) > MANY_REQUESTS:
        return Finding(False, expected, f"asked for the result {asked} times")
    if unreported := unreported_end(evidence):
        outcome, where, others = unreported
        return Finding(False, expected, f"where {where.name}: {outcome.missing(where, others)}")
    said = after_result(part)
    return Finding(True, expected, f"“{said[-1]}”" if said else "it did")


cancel = Draft(
    "exercise_1_3.cancel",
    "Exercise 1.3 · Cancel a goal",
    "Cancel a goal of order 20 after 3 to 5 feedback messages and report how it ended, or that it was rejected.",
    ActionClient(scenario, *MISTAKES),
)
cancel.asks("goal", 2, "Sends one goal of the right order", sends_the_goal)
cancel.asks("cancel", 3, "Asks to cancel at the right moment", cancels_in_the_window)
cancel.asks("once", 1, "Sends one request at that moment", cancels_once)
cancel.asks("late_feedback", 1, "Sends no other request when later feedback arrives", ignores_late_feedback)
cancel.asks("status", 2, "Reports how the goal really ended", reports_the_status, uses=("get_result_async",))
cancel.asks("refused", 1, "Says when the goal is rejected", tells_of_refusal)

EXERCISE = cancel.exercise(
    limit=120.0,
    text={
        "After the **third** feedback message, ask to cancel the goal.": "cancel",
        "A request after the fourth or the fifth message is accepted as well.": "cancel",
        "Ask only **once**, even if more feedback arrives or the server refuses to cancel": "once late_feedback",
        "Send a goal of order 20": "goal",
        "Send the goal: call `send_goal`": "goal",
        "raise a `RuntimeError` whose message contains `rejected`.": "refused",
        "There will be no result to wait for.": "refused",
        "Otherwise ask once for the result": "status",
        "While you wait, the client is spun": "cancel status",
        "report the status that you *really* got": "status",
        "Log or print the name of the final status": "status",
        "The number of the final status is accepted as well as its name": "status",
    },
)
