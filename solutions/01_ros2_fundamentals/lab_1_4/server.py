"""Lab 1.4: an action server that counts Fibonacci numbers, with feedback, cancel and refusal.

The judge is the client. In one run of the server it sends a goal alone, many that take no time, and the largest one,
which it cancels while a younger goal, nearly as large, goes on beside it; then the first goal again. A server that has
canceled rightly is asked to cancel twice more: a still younger goal beside the one that goes on, and a goal to which a
new one comes as soon as the server has agreed. If the server ends the older goal for the younger one, or agrees to
cancel it and goes on, the largest is sent and canceled once more, alone. In another run the judge sends orders that
must be refused, and two good goals to see that the node is still alive. A server may pace its work as it likes, so
orders are small where nothing else is going on.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from lab_1_4._compared import Goals, goals_seen, was_computed
from lab_1_4._goals import (
    ALONE,
    BESIDE,
    FIRST_TOO_LARGE,
    LONG_ALONE,
    NEXT,
    ORDERS,
    TWINS,
    YOUNGER,
    scenario,
)

from autograder.kit import Draft
from autograder.kit.oracle.action_server import SendsGoals
from autograder.kit.outcomes import SUCCEEDED, status_text

if TYPE_CHECKING:
    from autograder.kit import Finding

server = Draft(
    "lab_1_4.server",
    "Lab 1.4 · An action server that counts",
    "Serve the action fibonacci: feedback for each number, cancel at any time, bad orders rejected.",
    sends := SendsGoals(scenario, goals_seen),
)
server.asks("action", "Serves fibonacci, with the right type", sends.serves, points=1)


@server.criterion("sequence", "Succeeds with the right numbers", points=3)
def counts(seen: Goals, _: Goals) -> Finding:
    """Every good goal that has the server to itself succeeds with the reference's sequence.

    So does the large goal, as far as the numbers go that come when the others are over.
    """
    goals = [*seen.alone, *(one for one in seen.sent(BESIDE) if one.is_wrong_when_large)]
    expected = f"succeeds with {seen.longest[: max(ORDERS) + 1]} for order {max(ORDERS)}, and so on"
    return seen.find((one.fault for one in goals), expected, "it does", reached=bool(goals))


@server.criterion("feedback", "Sends feedback that grows by one number", points=1)
def gives_feedback(seen: Goals, _: Goals) -> Finding:
    """The feedback of a goal that has the server to itself grows by one number, while the server works.

    So does that of the large goal, if two at once do not disturb each other.
    """
    expected = "one more number in each feedback message"
    return seen.find(seen.feedback_faults, expected, "it does", reached=bool(seen.sent(ALONE)))


@server.criterion("two", "Serves two goals at once", points=1)
def serves_two_at_once(seen: Goals, _: Goals) -> Finding:
    """Two equal goals at once are right, and so are those beside a goal that is canceled, which ends as it should."""
    older = seen.ended_for_another
    faults = (
        f"the older goal ended as {status_text(older.status)} when the younger one came" if older else "",
        *(one.fault for one in seen.sent(*TWINS)),
        *(one.fault or one.slip for one in seen.sent(BESIDE, NEXT) if not one.is_wrong_when_large),
        *(one.fault for one in seen.sent(LONG_ALONE, YOUNGER) if one.accepted is False),
        *(f"{one}, which was to be canceled: status {status_text(one.status)}" for one in seen.astray),
    )
    expected = "each of two goals at once ends with its own sequence"
    return seen.find(faults, expected, "both are right", reached=bool(seen.sent(BESIDE)))


server.asks(
    "cancel", "Lets a goal be canceled", sends.cancels, uses=("is_cancel_requested", "canceled"), points=2
)
server.asks("refuse", "Rejects bad orders and lives on", sends.refuses, points=2)


server.knows(
    "bad_order_accepted",
    lambda seen, _: next((one for one in seen.bad if one.accepted and counts(seen, seen).passed), None),
    "Your server accepted a goal of {}, which it cannot serve: a sequence has no negative length, and from order "
    f"{FIRST_TOO_LARGE} on, its last number does not fit into an int32.",
    "The goal_callback decides on it: in the lab that is answer_goal. Let it return GoalResponse.REJECT if the order "
    f"is below 0 or above {FIRST_TOO_LARGE - 1}, and write goal_callback=answer_goal in the ActionServer.",
    certain=True,
    late=True,
)
server.knows(
    "wrong_sequence",
    lambda seen, _: next((one for one in seen.good if one.status == SUCCEEDED and one.fault), None),
    "For {0} the result is {0.result[sequence]}; it should be {0.due}.",
    "Begin with [0, 1] in each goal, and append the sum of the last two numbers, whatever its size, until there are "
    "order + 1.",
    certain=True,
    before="done_at_once",
)


def _wrong_feedback(seen: Goals, _: Goals) -> str:
    # What a goal that hangs has sent says nothing about feedback that does not grow by one number.
    told = [one for one in seen.good if was_computed(one) and not seen.may_have_lost(one)]
    faults = [one.feedback_fault for one in told if any(one.feedback for one in told)]
    return next(filter(None, faults), "")


server.knows(
    "wrong_feedback",
    lambda seen, _: seen.silent_again,
    "Your server sent feedback for a goal of {}, and none when such a goal came again: what one goal stored is still "
    "there for the next one.",
    "Begin with a new list in each goal: make it in the execute callback. What is stored outside of the callback, in "
    "self or in the module, belongs to all goals.",
    before="done_at_once",
)
server.knows(
    "wrong_feedback",
    _wrong_feedback,
    "The feedback is not one more number each time, up to the last number of the sequence ({}).",
    "Publish in each turn of the loop, right after you have appended a number: all numbers found so far, in "
    "partial_sequence. End the loop when the sequence is complete: for order 4 it has five numbers.",
    before="done_at_once",
)

EXERCISE = server.exercise(
    limit=180.0,
    remarks=(sends.remark,),
    text={
        "Reject a goal whose order is negative or greater than 46, and accept any other.": "refuse sequence",
        "Return one of two constants, `GoalResponse.ACCEPT` or `GoalResponse.REJECT`.": "refuse",
        "A canceled goal has a result, too: the numbers so far.": "cancel",
        "leave the loop if a cancel is requested": "cancel",
        "append the next number": "sequence",
        "publish the list as feedback": "feedback",
        "sleep for `PERIOD` seconds, instead of hard work.": "cancel",
        "After the loop say how the goal ended: call `canceled()` or `succeed()`.": "sequence cancel",
        "Each of two goals has to end with its own sequence": "two",
        "a cancel request has to end only the goal that it is about": "cancel two",
        "Let your node offer the action `fibonacci`.": "action",
        "Its method `on_cancel` accepts each cancel request": "cancel",
    },
    counts={
        "sequence": "For order 0, `[0, 1]` counts as well.",
        "feedback": "You may publish before you append: the result has the last number.",
        "two": "At the same time, or one after the other.",
        "cancel": "You may sleep from a tenth of a second to two seconds.",
    },
)
