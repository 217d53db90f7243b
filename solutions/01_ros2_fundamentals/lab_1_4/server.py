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

from lab_1_4 import _server_criteria as criteria
from lab_1_4._goals import (
    AGAIN,
    ALONE,
    BAD_ORDERS,
    BESIDE,
    FIRST_TOO_LARGE,
    GOALS,
    LAST_ORDER,
    LONG_ALONE,
    NEXT,
    ROUNDS_LEFT,
    TWINS,
    YOUNGER,
    all_goals,
    before_any_cancel,
    ended_by_a_younger,
    expected_sequence,
    feedback_objection,
    feedback_slip,
    goal,
    good_goals,
    objection,
    paced_goals,
    takes_no_time,
    to_be_canceled,
)
from lab_1_4._server_run import scenario

from autograder.kit.draft import Draft
from autograder.kit.mistakes.crashes import traceback_of
from autograder.kit.model import Advice
from autograder.kit.outcomes import SUCCEEDED, status_text
from autograder.kit.recipes.servers import SendsGoals, is_quick

if TYPE_CHECKING:
    from autograder.kit.evidence import Evidence

CANCELED_UNASKED = "with event CANCELED"
"""In what rclpy raises if canceled() is called for a goal that no client has asked to cancel."""
server = Draft(
    "lab_1_4.server",
    "Lab 1.4 · An action server that counts",
    "Serve the action fibonacci: feedback for each number, cancel at any time, bad orders rejected.",
    sends := SendsGoals(scenario, good=good_goals, canceled=to_be_canceled),
)
server.asks("action", 1, "Serves fibonacci, with the right type", criteria.serves)
server.asks("sequence", 3, "Succeeds with the right numbers", criteria.counts)
server.asks("feedback", 1, "Sends feedback that grows by one number", criteria.gives_feedback)
server.asks("two", 1, "Serves two goals at once", criteria.serves_two_at_once)
server.asks(
    "cancel", 2, "Lets a goal be canceled", criteria.lets_cancel, uses=("is_cancel_requested", "canceled")
)
server.asks("refuse", 2, "Rejects bad orders and lives on", criteria.refuses_bad_orders)


@server.mistake("bad_order_accepted", certain=True)
def only_bad_orders(seen: Evidence, _: Evidence) -> Advice | None:
    """All else is right."""
    rest = (criteria.counts, criteria.gives_feedback, criteria.serves_two_at_once, criteria.lets_cancel)
    return bad_order_accepted(seen, seen) if all(judge(seen).passed for judge in rest) else None


@server.mistake("goal_rejected", certain=True, before="cancel_not_accepted")
def goal_rejected(seen: Evidence, _: Evidence) -> Advice | None:
    """A good goal is refused."""
    last = [one for one in all_goals(seen.part(BAD_ORDERS)) if one.order == LAST_ORDER]
    beside = [goal(seen.part(GOALS), number) for number in (*TWINS, BESIDE, LONG_ALONE, NEXT, YOUNGER)]
    good = (*good_goals(seen), to_be_canceled(seen), *beside, *last)
    refused = [one for one in good if one.accepted is False]
    if not refused or traceback_of(seen):
        return None
    if len(refused) < sum(one.accepted is not None for one in good):
        return Advice(
            f"Your server rejected a goal of order {refused[0].order}, which is a good one, and took others.",
            f"Look at the comparison in your goal_callback: all orders from 0 to {FIRST_TOO_LARGE - 1} can be served, "
            "also while another goal is at work.",
        )
    return Advice(
        f"Your server rejected a goal of order {refused[0].order}, which is a good one. A goal_callback that returns "
        "True (or anything but GoalResponse.ACCEPT) rejects.",
        "Return GoalResponse.ACCEPT for the orders that you can serve, and GoalResponse.REJECT for the others.",
    )


def result_never_filled(seen: Evidence, _: Evidence) -> bool:
    """Every goal succeeds with an empty sequence."""
    good = [one for one in paced_goals(seen) if one.status == SUCCEEDED]
    return bool(good) and not any(one.sequence for one in good)


server.knows(
    "field_typo",
    result_never_filled,
    "The goals succeed, but the result is empty: its field sequence was never filled.",
    "Set the field sequence of your result before you return it. A misspelt keyword in Fibonacci.Result(...) "
    "is ignored silently.",
    certain=True,
    before="cancel_not_accepted",
)


server.knows(
    "older_goal_ended",
    lambda seen, _: any(CANCELED_UNASKED in str(e.data) for e in before_any_cancel(seen.part(GOALS)).events),
    "When a second goal came, your server called canceled() for the older one. No client had asked to cancel that "
    "goal, so canceled() raised an error.",
    "Serve both goals, each with its own sequence. (A server that gives up a goal by itself calls abort().)",
    certain=True,
)
server.knows(
    "older_goal_ended",
    lambda seen, _: (
        not traceback_of(seen)
        and (older := ended_by_a_younger(seen.part(GOALS)))
        and status_text(older.status)
    ),
    "When a second goal came, your server ended the older one as {}. The task asks it to serve both, each "
    "with its own sequence.",
    "Leave out what aborts the goal that is at work when another one is accepted; or let the new one wait until the "
    "older one has ended.",
    certain=True,
)


@server.mistake("goals_mixed_up")
def goals_mixed_up(seen: Evidence, _: Evidence) -> Advice | None:
    """Alone it is right, two at once are not."""
    part = seen.part(GOALS)
    alone, beside, again, following = (goal(part, number) for number in (ALONE, BESIDE, AGAIN, NEXT))
    if objection(seen, alone) or feedback_objection(seen, alone):
        return None
    ended = [one for one in (beside, again, following) if one.status is not None]
    slips = [(one, text) for one in ended if (text := feedback_slip(seen, one))]
    wrong = slips or [(one, text) for one in ended if (text := objection(seen, one))]
    astray = criteria.goes_on_beside_another(part)
    unasked = CANCELED_UNASKED in traceback_of(seen)
    # If the numbers of two goals get into one list, they grow too large, and that is an exception, too.
    if not (wrong or astray or unasked) or (traceback_of(seen) and not (slips or astray or unasked)):
        return None
    only_beside = [one for one, _ in wrong] == [beside] and again in ended
    if only_beside and not (astray or unasked) and beside.status == SUCCEEDED and beside.grows:
        return None  # two at once are right, and large numbers are not
    words = [text for _, text in wrong]
    words += [f"order {one.order}: it goes on, although your server agreed to stop" for one in astray]
    words.append("canceled() was called for a goal that nobody had asked to cancel")
    canceled_at = to_be_canceled(seen).cancel_answered_at
    stopped_too = to_be_canceled(seen).cancel_accepted and beside.sent_after(canceled_at) <= ROUNDS_LEFT
    if astray or unasked or wrong[0][0] != beside or (stopped_too and not slips):
        return Advice(
            f"When one goal was canceled, a goal went wrong ({words[0]}).",
            "Ask the goal handle of each goal: its is_cancel_requested is True only for the goal that is to stop. A "
            "flag, a goal handle or a list in self belongs to all goals, and keeps its value for later ones.",
        )
    return Advice(
        f"One goal alone is right, but of two at once one is not ({words[0]}): they disturb each other.",
        "Keep the sequence in a variable of the execute callback. What is stored in self is shared by all goals, and "
        "lives on after each.",
    )


@server.mistake("wrong_sequence", certain=True, before="cancel_not_accepted")
def wrong_sequence(seen: Evidence, _: Evidence) -> Advice | None:
    """A goal succeeds with other numbers than the reference's."""
    wrong = [one for one in good_goals(seen) if one.status == SUCCEEDED and objection(seen, one)]
    if not wrong:
        return None
    wanted = expected_sequence(seen, int(wrong[0].order or 0))
    return Advice(
        f"For order {wrong[0].order} the result is {wrong[0].sequence}; it should be {wanted}.",
        "Begin with [0, 1] in each goal, and append the sum of the last two numbers, whatever its size, until there "
        "are order + 1.",
    )


@server.mistake("wrong_feedback", before="cancel_not_accepted")
def wrong_feedback(seen: Evidence, _: Evidence) -> Advice | None:
    """Feedback comes, and does not grow by one number. What a goal that hangs has sent says nothing about that."""
    told = [one for one in paced_goals(seen) if one.was_computed]
    if not any(one.feedback for one in told):
        return None
    wrong = [(one, text) for one in told if (text := feedback_objection(seen, one))]
    if not wrong:
        return None
    return Advice(
        f"The feedback is not one more number each time, up to the last number of the sequence ({wrong[0][1]}).",
        "Publish in each turn of the loop, right after you have appended a number: all numbers found so far, in "
        "partial_sequence. End the loop when the sequence is complete: for order 4 it has five numbers.",
    )


@server.mistake("done_at_once", before="cancel_not_accepted")
def done_at_once(seen: Evidence, _: Evidence) -> Advice | None:
    """The long goal was over before it could be canceled, or nearly so."""
    long = to_be_canceled(seen)
    quick = long.status == SUCCEEDED and not long.cancel_accepted and is_quick(long)
    # Whether the cancel got in between, and whether the result was seen, is then up to the machine.
    ended = long.cancelled_too_late or long.status is not None
    if not quick and not (ended and takes_no_time(seen.part(GOALS))):
        return None
    return Advice(
        f"A goal of order {long.order} was done at once: there was no time to cancel it.",
        "Take some time for each number, for example time.sleep(0.5): an action is for work that takes long.",
    )


@server.mistake("bad_order_accepted", certain=True, late=True)
def bad_order_accepted(seen: Evidence, _: Evidence) -> Advice | None:
    """A bad order is taken on."""
    bad = (one for one in all_goals(seen.part(BAD_ORDERS)) if one.order != LAST_ORDER)
    order = next((int(one.order or 0) for one in bad if one.accepted), None)
    if order is None or not criteria.counts(seen).passed:
        return None
    too_large = f"from order {FIRST_TOO_LARGE} on, the last number does not fit into an int32"
    why = "there is no sequence of a negative length" if order < 0 else too_large
    return Advice(
        f"Your server accepted a goal of order {order}, which it cannot serve: {why}.",
        "The goal_callback decides on it: in the lab that is answer_goal. Let it return GoalResponse.REJECT where the "
        f"order is below 0 or above {FIRST_TOO_LARGE - 1}, and write goal_callback=answer_goal in the ActionServer.",
    )


def feedback_after_the_end(evidence: Evidence) -> str:
    """Return a remark if the server sent feedback after it had said that the goal was over."""
    part = evidence.part(GOALS)
    ends = [(goal(part, int(event.data["goal"])), event.data["sent"]) for event in part.of("goal_ended")]
    words = "Your server publishes feedback after it has ended the goal. Later releases of ROS drop such feedback."
    return words if any(one.sent_after(end) for one, end in ends) else ""


EXERCISE = server.exercise(
    limit=180.0,
    remarks=(feedback_after_the_end,),
    text={
        "Reject a goal whose order is negative or greater than 46, and accept any other.": "refuse sequence",
        "0 is a good order: its sequence is a single number.": "sequence",
        "For order 0, the sequence `[0, 1]` is accepted as well.": "sequence",
        "Return one of two constants, `GoalResponse.ACCEPT` or `GoalResponse.REJECT`.": "refuse",
        "Call exactly one of the last three:": "sequence cancel",
        "A canceled goal has a result, too: the numbers so far.": "cancel",
        "leave the loop if a cancel is requested": "cancel",
        "append the next number": "sequence",
        "publish the list as feedback": "feedback",
        "sleep for `PERIOD` seconds, instead of hard work.": "cancel",
        "After the loop say how the goal ended: call `canceled()` or `succeed()`.": "sequence cancel",
        "Each of two goals has to end with its own sequence": "two",
        "a cancel request has to end only the goal that it is about": "cancel two",
        "Let your node offer the action `fibonacci`.": "action",
    },
)
