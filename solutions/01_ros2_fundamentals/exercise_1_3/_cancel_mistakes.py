"""Known mistakes of clients that cancel a goal, and what to do about them."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from exercise_1_3._cancel_evidence import (
    AGREED,
    CANCEL_REFUSED,
    FIRST_FEEDBACK,
    HONOURED,
    LAST_FEEDBACK,
    asks_again_when_refused,
    cancels_every_goal,
    expected_order,
    goals,
    left_before_its_answer,
    orders_as_seen,
    telling_count,
    unreported_end,
)

from autograder.kit.in_words import counted
from autograder.kit.mistakes import goal_mistakes
from autograder.kit.mistakes.common_mistakes import AWAITS_IN_VAIN, only_if_ended, went_deaf
from autograder.kit.mistakes.crashes import meant
from autograder.kit.mistakes.hangs import HANGS
from autograder.kit.model import Advice, Mistake

if TYPE_CHECKING:
    from autograder.kit.evidence import Evidence

HOW = {
    HONOURED: "was canceled",
    CANCEL_REFUSED: "succeeded in spite of the cancel request",
    AGREED: "was aborted, though the server had agreed to cancel it",
}
"""The ends of the goals in words."""
WAITS_FOR_ITSELF = ("nested_spin", "call_in_same_group")
"""Hangs that no time can end. In the others the client may be busy with something that comes to an end."""


def wrong_order(evidence: Evidence) -> Advice | None:
    """A goal of another order, or more than one."""
    wrong, wanted = orders_as_seen(evidence), expected_order(evidence)
    if not wrong:
        return None
    return Advice(
        f"The judge got {wrong}; the task asks for one goal of order {wanted}.",
        f"Set the field order of your goal to {wanted}, and send the goal once. Where it is rejected, say so, and send "
        "no other.",
    )


def not_waited_for(evidence: Evidence) -> Advice | None:
    """The client existed, but none of its goals reached the server, which came a moment later."""
    part = evidence.main
    returned_silently = part.returned is not None and not part.said()
    if goals(part) or part.traceback or returned_silently or not evidence.ever_had("action_client"):
        return None
    return Advice(
        "The server was there, or came a moment after your client, and no goal of your client ever reached it.",
        "Wait for the server with a few seconds of patience, and raise or end where it does not come: "
        "`if not your_action_client.wait_for_server(timeout_sec=5.0):`. It returns True when the server is there; a "
        "goal that is sent before is lost.",
    )


def ended_on_the_way(evidence: Evidence) -> Advice | None:
    """The client ended before it had to cancel, or before the answer to its cancel request."""
    part = evidence.main
    ending, cancel = part.ending, part.first("cancel")
    if not goals(part) or ending is None or (part.traceback and not meant(part.traceback)):
        return None
    before = part.events[: part.events.index(ending)]
    if cancel is None and not any(event.kind == "result" for event in before):
        missing = "it had asked to cancel it"
    elif left_before_its_answer(part):
        missing = "its result was there"
    else:
        return None
    return Advice(
        f"Your client sent its goal, and ended before {missing}.",
        "Keep it alive until the result is there: rclpy.spin(your_node), or "
        "rclpy.spin_until_future_complete(your_node, your_future, timeout_sec=30.0). A single spin_once takes in one "
        "thing only.",
    )


def cancel_missing(evidence: Evidence) -> Advice | None:
    """A goal, feedback, and no request to cancel this goal."""
    part = evidence.main
    if cancels_every_goal(evidence):
        return Advice(
            "The cancel request of your client has no goal's id. That asks the server to cancel all its goals, also "
            "those of other clients.",
            "Call cancel_goal_async() of the goal handle: it asks for this one goal to be canceled.",
        )
    if not goals(part) or part.first("cancel") is not None:
        return None
    return Advice(
        "Your client sent its goal and got its feedback, but it never asked to cancel.",
        "Count in the feedback callback, once for each message, compare the count with a number, as in "
        "`if self.feedback_count == 3:`, and call cancel_goal_async() of the goal handle there. The handle is the "
        "answer to the goal: keep it.",
    )


def cancel_too_early(evidence: Evidence) -> Advice | None:
    """Fewer feedback messages than the task asks for."""
    count = telling_count(evidence)
    if count is None or count >= FIRST_FEEDBACK:
        return None
    return Advice(
        f"Your client asked to cancel after {counted(count, 'feedback message')}; the task asks for {FIRST_FEEDBACK} "
        f"to {LAST_FEEDBACK}.",
        f"Count the calls of the feedback callback and cancel when the count reaches {FIRST_FEEDBACK}. (A timer of a "
        "fixed length does not know how fast the server is.)",
    )


def cancel_too_late(evidence: Evidence) -> Advice | None:
    """More feedback messages than the task asks for."""
    count = telling_count(evidence)
    if count is None or count <= LAST_FEEDBACK:
        return None
    return Advice(
        f"Your client asked to cancel only after {count} feedback messages; the task asks for {FIRST_FEEDBACK} to "
        f"{LAST_FEEDBACK}.",
        f"Cancel in the feedback callback, when your count of the messages is {FIRST_FEEDBACK}. (A timer of a fixed "
        "length does not know how fast the server is.)",
    )


def cancel_repeated(evidence: Evidence) -> Advice | None:
    """More than one cancel request."""
    if asks_again_when_refused(evidence):
        total = len(evidence.part(CANCEL_REFUSED).of("cancel"))
        return Advice(
            f"The server refused to cancel the goal, and your client asked {total} times in all; the task asks for one "
            "request.",
            "A server may say no. Do not ask again: wait for the result, and report how the goal really ended.",
        )
    total = len(evidence.main.of("cancel"))
    if total < 2:
        return None
    return Advice(
        f"Your client asked to cancel {total} times in all; the task asks for one request. Feedback goes on "
        "arriving until the server has ended the goal.",
        "Ask at one moment only: in the feedback callback compare your count with `== 3` rather than `>= 3`. Where a "
        "timer asks, stop it with its cancel(); where a loop asks, put the request before the loop.",
    )


def status_not_reported(evidence: Evidence) -> Advice | None:
    """The client cancels, but never says how one of its goals ended."""
    part, unreported = evidence.part(HONOURED), unreported_end(evidence)
    if part.first("cancel") is None or unreported is None:
        return None
    outcome, where, others = unreported
    if where is part and part.first("result_request") is None:
        return Advice(
            "Your client asked to cancel, but it never asked for the result, so it cannot know how the goal ended.",
            "Call get_result_async() of the goal handle once the goal is accepted, and read the status of its result() "
            "when that future is done. Leave out an rclpy.spin(...) before that: it does not come back.",
        )
    return outcome.advice(
        where,
        others,
        f"The judge ran your client several times. In one run its goal {HOW[where.name]}",
        "A cancel is a request. The server may refuse it, or agree to it and end the goal in another way. So log the "
        "status of the result each time, by its name, or by its number behind the word `status`.",
    )


MISTAKES = (
    Mistake("wrong_order", wrong_order, certain=True),
    Mistake("ended_too_early", ended_on_the_way),
    *(replace(hang, certain=hang.key in WAITS_FOR_ITSELF) for hang in HANGS),
    Mistake("gave_up_too_early", not_waited_for),
    AWAITS_IN_VAIN,
    went_deaf("action_client"),
    Mistake("cancel_missing", cancel_missing),
    Mistake("cancel_repeated", cancel_repeated, certain=True),
    Mistake("cancel_too_early", cancel_too_early),
    Mistake("cancel_too_late", cancel_too_late),
    only_if_ended(Mistake("status_not_reported", status_not_reported)),
    Mistake("status_not_reported", status_not_reported),
    goal_mistakes.RESULT_OF_REJECTED_GOAL,
    goal_mistakes.REFUSAL_NOT_REPORTED,
    goal_mistakes.STAYS_AFTER_REFUSAL,
)
"""Most telling first, between those that any client of an action may show."""
