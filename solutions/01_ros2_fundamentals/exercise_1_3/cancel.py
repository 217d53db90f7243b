"""Exercise 1.3: a client that cancels its goal after a few feedback messages and reports how the goal ended."""

from __future__ import annotations

import sys
from functools import partial
from typing import TYPE_CHECKING

from autograder.kit import Advice, Draft, Mistake, mistake, unless
from autograder.kit.goal_reports import (
    MANY_REQUESTS,
    NOT_AWAITED,
    REFUSED,
    asked_for,
    left_at_once,
    tells_of_refusal,
)
from autograder.kit.in_words import counted
from autograder.kit.mistakes import goal_mistakes
from autograder.kit.mistakes.common_mistakes import AWAITS_IN_VAIN, only_if_ended, went_deaf
from autograder.kit.mistakes.crashes import meant
from autograder.kit.mistakes.hangs import HANGS
from autograder.kit.oracle.cancel_requests import (
    CANCEL_REFUSED,
    HONORED,
    cancel_request,
    no_cancel,
    requests_at_that_moment,
    unreported_end,
)
from autograder.kit.oracle.canceled_goals import CancelsGoal

if TYPE_CHECKING:
    from collections.abc import Container

    from autograder.kit import Evidence

FIRST, LAST = 3, 5
"""The request must come after this many feedback messages, at the earliest and at the latest."""
WINDOW = f"after {FIRST} to {LAST} feedback messages"
AGAIN = "nothing more is asked for"
ENDS = "says `canceled`, `succeeded` or `aborted`, or `status` and the number, as each goal ended"


def numbers(feedbacks: int) -> list[int]:
    """Return the sequence that the server has after so many feedback messages; the first one brings two numbers."""
    sequence = [0, 1]
    for _ in range(feedbacks + 1 if feedbacks else 0):
        sequence.append(sequence[-1] + sequence[-2])
    return sequence


# --- what is wrong, in words; empty if nothing is -----------------------------------------------------------


def orders(evidence: Evidence) -> str:
    """Each run must have one goal, of the reference's order."""
    made, refused = asked_for(evidence.main), asked_for(evidence.part(REFUSED))
    if len(made) > 1:
        return f"{len(made)} goals"
    if made and made != asked_for(evidence.reference.part(HONORED)):
        return f"order {made[0]}"
    return f"{len(refused)} goals, as the first was rejected" if made and len(refused) > 1 else ""


def goal(evidence: Evidence) -> str:
    """The client must send its goal, and wait for the answer to it."""
    if not evidence.main.of("goal"):
        return "no goal"
    return NOT_AWAITED if left_at_once(evidence.main) else orders(evidence)


def moment(evidence: Evidence) -> int | None:
    """Return the number of messages before the request; None if a run has no request.

    Of wrong numbers, it is the smallest: a client that goes by a clock is too early where the server is slow, and how
    late it is where the server is quick is up to the machine.
    """
    runs = [part for name in (HONORED, CANCEL_REFUSED) if (part := evidence.part(name)).of("goal")]
    requests = [cancel_request(part) for part in runs]
    counts = [request.count for request in requests if request]
    wrong = [count for count in counts if not FIRST <= count <= LAST]
    if wrong:
        return min(wrong)
    return counts[0] if requests and len(counts) == len(requests) else None


def every_goal(evidence: Evidence) -> str:
    """A request without a goal's id asks for every goal of the server (action_msgs/srv/CancelGoal)."""
    cancel = evidence.main.first("cancel")
    return "a request to cancel every goal of the server" if cancel and cancel.data.get("every") else ""


def wrong_moment(evidence: Evidence) -> str:
    """The first request must come in the window. With two goals it is unclear whose feedback the client counts."""
    count, goals = moment(evidence), len(evidence.main.of("goal"))
    if wrong := no_cancel(evidence.main) or every_goal(evidence):
        return wrong
    seen = "no cancel request" if count is None else f"after {counted(count, 'feedback message')}"
    if goals > 1:
        return f"{seen}, with {goals} goals sent"
    return "" if count is not None and FIRST <= count <= LAST else seen


def asks_when_refused(evidence: Evidence) -> int:
    """Return the number of requests of a client that asks again only if the server refuses; otherwise 0."""
    refused = len(evidence.part(CANCEL_REFUSED).of("cancel"))
    return refused if refused > 1 == len(evidence.main.of("cancel")) else 0


def repeated(evidence: Evidence) -> str:
    """There must be no second request before late feedback arrives, and none if the first is refused."""
    if wrong := no_cancel(evidence.main):
        return wrong
    if total := asks_when_refused(evidence):
        return f"{total} cancel requests where the server refuses"
    count, _ = requests_at_that_moment(evidence.main)
    return f"{count} cancel requests, before more feedback arrived" if count > 1 else ""


def acts_again(evidence: Evidence) -> str:
    """Late feedback must cause no request and no goal.

    A client that requests again before any arrives uses a clock: chance decides whether it ticks during late feedback,
    and :func:`repeated` judges that.
    """
    if wrong := no_cancel(evidence.main):
        return wrong
    count, later = requests_at_that_moment(evidence.main)
    acted = [event.kind for event in later if event.kind == "goal" or (event.kind == "cancel" and count == 1)]
    return f"{len(acted)} more {acted[0]} requests" if acted else ""


def unsaid(evidence: Evidence) -> str:
    """The client must say of each goal how it ended."""
    if evidence.main.first("cancel") is None:
        return "no cancel request"
    if (asked := len(evidence.main.of("result_request"))) > MANY_REQUESTS:
        return f"asked for the result {asked} times"
    if unreported := unreported_end(evidence):
        outcome, where, others = unreported
        return f"where {where.name}: {outcome.missing(where, others)}"
    return ""


# --- known mistakes -----------------------------------------------------------------------------------------


def asked_after(counts: Container[int], evidence: Evidence) -> str:
    """Return after how many messages the client asked, in words, if it is one of these counts."""
    count = moment(evidence)
    return counted(count, "feedback message") if count is not None and count in counts else ""


def lost_goal(evidence: Evidence) -> bool:
    """The client existed, but none of its goals reached the server, which came a moment later."""
    part = evidence.main
    returned_silently = part.returned is not None and not part.said()
    reached = part.of("goal") or part.traceback or returned_silently
    return not reached and evidence.ever_had("action_client")


def ended_before(evidence: Evidence) -> str:
    """Return what the client did not wait for."""
    part, ending = evidence.main, evidence.main.ending
    if not part.of("goal") or ending is None or (part.traceback and not meant(part.traceback)):
        return ""
    if part.first("cancel"):
        return "its result was there" if no_cancel(part) else ""
    had_result = any(event.kind == "result" for event in part.events[: part.events.index(ending)])
    return "" if had_result else "it had asked to cancel it"


def not_reported(evidence: Evidence) -> Advice | None:
    """The client cancels, but never says how one of its goals ended."""
    part, unreported = evidence.main, unreported_end(evidence)
    if part.first("cancel") is None or unreported is None:
        return None
    outcome, where, others = unreported
    if where.name == HONORED and part.first("result_request") is None:
        return Advice(
            "Your client asked to cancel, but it never asked for the result, so it cannot know how the goal ended.",
            "Call get_result_async() of the goal handle once the goal is accepted, and read the status of its result() "
            "when that future is done. Leave out an rclpy.spin(...) before that: it does not come back.",
        )
    return outcome.advice(
        where,
        others,
        f"The judge ran your client several times. In one run, {where.name}, and the goal ends as {outcome.word}",
        "A cancel is a request. The server may refuse it, or agree to it and end the goal in another way. So log the "
        "status of the result each time, by its name, or by its number behind the word `status`.",
    )


NOT_REPORTED = Mistake("status_not_reported", not_reported)
MISTAKES = (
    mistake(
        "wrong_order",
        lambda evidence: (
            (wrong := orders(evidence)) and (wrong, *asked_for(evidence.reference.part(HONORED)))
        ),
        "The judge got {0[0]}; the task asks for one goal of order {0[1]}.",
        "Set the field order of your goal to {0[1]}, and send the goal once. Where it is rejected, say so, and send no "
        "other.",
        certain=True,
    ),
    mistake(
        "ended_too_early",
        ended_before,
        "Your client sent its goal, and ended before {}.",
        "Keep it alive until the result is there: rclpy.spin(your_node), or rclpy.spin_until_future_complete("
        "your_node, your_future, timeout_sec=30.0). A single spin_once takes in one thing only.",
    ),
    *HANGS,
    mistake(
        "gave_up_too_early",
        lost_goal,
        "The server was there, or came a moment after your client, and no goal of your client ever reached it.",
        "Wait for the server with a few seconds of patience, and raise or end where it does not come: `if not "
        "your_action_client.wait_for_server(timeout_sec=5.0):`. It returns True when the server is there; a goal that "
        "is sent before is lost.",
    ),
    AWAITS_IN_VAIN,
    went_deaf("action_client"),
    mistake(
        "cancel_missing",
        every_goal,
        "The cancel request of your client has no goal's id. That asks the server to cancel all its goals, also those "
        "of other clients.",
        "Call cancel_goal_async() of the goal handle: it asks for this one goal to be canceled.",
    ),
    mistake(
        "cancel_missing",
        lambda evidence: evidence.main.of("goal") and not evidence.main.of("cancel"),
        "Your client sent its goal and got its feedback, but it never asked to cancel.",
        "Count in the feedback callback, once for each message, compare the count with a number, as in `if "
        "self.feedback_count == 3:`, and call cancel_goal_async() of the goal handle there. Keep the handle: it is the "
        "answer to the goal.",
    ),
    mistake(
        "cancel_repeated",
        asks_when_refused,
        "The server refused to cancel the goal, and your client asked {} times in all; the task asks for one request.",
        "A server may say no. Do not ask again: wait for the result, and report how the goal really ended.",
        certain=True,
    ),
    mistake(
        "cancel_repeated",
        lambda evidence: (total := len(evidence.main.of("cancel"))) > 1 and total,
        "Your client asked to cancel {} times in all; the task asks for one request. Feedback goes on arriving until "
        "the server has ended the goal.",
        "Ask at one moment only: in the feedback callback compare your count with `== 3` rather than `>= 3`. Where a "
        "timer asks, stop it with its cancel(); where a loop asks, put the request before the loop.",
        certain=True,
    ),
    *(
        mistake(
            f"cancel_too_{when}",
            partial(asked_after, counts),
            f"Your client asked to cancel after {{}}; the task asks for {FIRST} to {LAST}.",
            f"Count the calls of the feedback callback, and cancel when the count is {FIRST}. (A timer of a fixed "
            "length does not know how fast the server is.)",
        )
        for when, counts in (("early", range(FIRST)), ("late", range(LAST + 1, sys.maxsize)))
    ),
    only_if_ended(NOT_REPORTED),
    NOT_REPORTED,
    goal_mistakes.RESULT_OF_REJECTED_GOAL,
    goal_mistakes.REFUSAL_NOT_REPORTED,
    goal_mistakes.STAYS_AFTER_REFUSAL,
)
"""Most telling first, between those that any client of an action may show."""

cancel = Draft(
    "exercise_1_3.cancel",
    "Exercise 1.3 · Cancel a goal",
    "Cancel a goal of order 20 after 3 to 5 feedback messages and report how it ended, or that it was rejected.",
    CancelsGoal(
        (FIRST, LAST),
        lambda feedbacks: {"partial_sequence": numbers(feedbacks)},
        lambda feedbacks: {"sequence": numbers(feedbacks)},
        *MISTAKES,
    ),
)
cancel.asks("goal", "Sends one goal of the right order", unless("one goal of order 20", goal), points=2)
cancel.asks("cancel", "Asks to cancel at the right moment", unless(WINDOW, wrong_moment), points=3)
cancel.asks(
    "once", "Sends one request at that moment", unless("one request at that moment", repeated), points=1
)
cancel.asks(
    "late_feedback", "Sends no other request when later feedback arrives", unless(AGAIN, acts_again), points=1
)
cancel.asks(
    "status", "Reports how the goal really ended", unless(ENDS, unsaid), uses=("get_result_async",), points=2
)
cancel.asks("refused", "Says when the goal is rejected", tells_of_refusal, points=1)

EXERCISE = cancel.exercise(
    limit=120.0,
    text={
        "After the **third** feedback message, ask to cancel the goal.": "cancel",
        "Ask only **once**, even if more feedback arrives or the server refuses to cancel": "once late_feedback",
        "Send a goal of order 20": "goal",
        "Send the goal: call `send_goal`": "goal",
        "raise a `RuntimeError` whose message contains `rejected`.": "refused",
        "There will be no result to wait for.": "refused",
        "Otherwise ask once for the result": "status",
        "While you wait, the client is spun": "cancel status",
        "report the status that you *really* got": "status",
        "Log or print the name of the final status": "status",
        "Wait for it at most 30 s": "",
    },
    counts={
        "cancel": "After the fourth or the fifth message counts as well.",
        "status": "You may ask for the result up to three times. `status: 5` or `cancelled` counts as well.",
        "refused": "Any exception, or a line that contains `rejected`.",
        "": "`add_done_callback` is not graded.",
    },
)
