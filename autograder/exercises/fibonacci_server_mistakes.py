"""Known mistakes of an action server, told from what the judge's action client has seen."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from autograder.exercises import common_mistakes as common
from autograder.exercises.crashes import traceback_of
from autograder.exercises.fibonacci_goals import (
    ABORTED,
    ALONE,
    BAD_ORDERS,
    CANCELED,
    FIRST_OF_TWO,
    FIRST_TOO_LARGE,
    GOALS,
    LAST_ORDER,
    LONG,
    SECOND_OF_TWO,
    SUCCEEDED,
    Goal,
    all_goals,
    expected_sequence,
    feedback_objection,
    goal,
    good_goals,
    objection,
    status_text,
    takes_no_time,
)
from autograder.exercises.fibonacci_server_criteria import (
    counts,
    gives_feedback,
    is_the_part,
    lets_cancel,
    servers,
    serves_two_at_once,
)
from autograder.exercises.hangs import HANGS
from autograder.exercises.model import Advice, Mistake

if TYPE_CHECKING:
    from autograder.exercises.evidence import Evidence

AT_ONCE = 0.3
"""Seconds in which twenty numbers are found only by a server that takes no time for any of them."""
MANY = 2
"""Feedback messages in a row that show that a server does not read a request while it works."""


def two_servers(evidence: Evidence) -> Advice | None:
    """Two servers share the name."""
    name, _ = evidence.reference.only("action_server")
    count = servers(evidence.main)
    if count < 2:
        return None
    return Advice(
        f"{count} servers of {name} are on the graph. Each goal reaches both, and both execute it.",
        "Make one ActionServer only, and one node.",
    )


def goal_rejected(evidence: Evidence) -> Advice | None:
    """A good goal is refused."""
    refused = [
        seen for seen in (*good_goals(evidence), goal(evidence.part(GOALS), LONG)) if seen.accepted is False
    ]
    if not refused or traceback_of(evidence):
        return None
    return Advice(
        f"Your server refused a goal of order {refused[0].order}, which is a good one. A goal_callback that returns "
        "True (or anything but GoalResponse.ACCEPT) refuses.",
        "Return GoalResponse.ACCEPT for the orders that you can serve, and GoalResponse.REJECT for the others.",
    )


def goal_not_succeeded(evidence: Evidence) -> Advice | None:
    """The goal is aborted because nobody said that it succeeded."""
    aborted = [seen for seen in good_goals(evidence) if seen.status == ABORTED]
    if not aborted or traceback_of(evidence):
        return None
    return Advice(
        "The goal ended as ABORTED (6) although the work was done: rclpy assumes so when the execute callback returns "
        "without a word.",
        "Call goal_handle.succeed() before you return the result.",
    )


def result_missing(evidence: Evidence) -> Advice | None:
    """The execute callback returned no result."""
    return (
        Advice(
            "The execute callback returned nothing, so there is no result to send.",
            "End it with `return result`, where result is a Fibonacci.Result() whose sequence you have filled. Do so "
            "on every way out, after a cancel too.",
        )
        if _returned_nothing(evidence)
        else None
    )


def _returned_nothing(evidence: Evidence) -> bool:
    # What rclpy says when it sends the result, and what autograder/notebook says in its place.
    said = r"'NoneType' object has no attribute '_?sequence'|must return a result of the action"
    return re.search(said, traceback_of(evidence)) is not None


def exception_in_execute(evidence: Evidence) -> Advice | None:
    """The execute callback raised, so rclpy aborted the goal."""
    traceback = traceback_of(evidence)
    if not traceback or not any(seen.status == ABORTED for part in evidence for seen in all_goals(part)):
        return None
    last = next((line for line in reversed(traceback.splitlines()) if line.strip()), "")
    return Advice(
        f"The execute callback raised an exception, so rclpy aborted the goal: {last.strip()}",
        "Read the traceback from the bottom: the last line says what, the line above it where. Mend that line.",
    )


def result_never_filled(evidence: Evidence) -> Advice | None:
    """Every goal succeeds with an empty sequence."""
    good = [seen for seen in good_goals(evidence) if seen.status == SUCCEEDED]
    if not good or any(seen.sequence for seen in good):
        return None
    return Advice(
        "The goals succeed, but the result is empty: its field sequence was never filled.",
        "Set result.sequence before you return the result. A misspelt keyword in Fibonacci.Result(...) is ignored "
        "silently.",
    )


def goals_mixed_up(evidence: Evidence) -> Advice | None:
    """Alone it is right, two at once are not."""
    if not goal(evidence.part(GOALS), FIRST_OF_TWO).accepted or objection(
        evidence, goal(evidence.part(GOALS), ALONE)
    ):
        return None
    two = [goal(evidence.part(GOALS), number) for number in (FIRST_OF_TWO, SECOND_OF_TWO)]
    wrong = [
        text
        for s in two
        if s.status is not None and (text := objection(evidence, s) or feedback_objection(evidence, s))
    ]
    if not wrong or feedback_objection(evidence, goal(evidence.part(GOALS), ALONE)):
        return None
    return Advice(
        f"One goal alone is right, but of two at once one is not ({wrong[0]}): they disturb each other.",
        "Keep the sequence in a variable of the execute callback. What is stored in self is shared by all goals, and "
        "lives on after each.",
    )


def wrong_sequence(evidence: Evidence) -> Advice | None:
    """A goal succeeds with other numbers than the reference's."""
    wrong = [seen for seen in good_goals(evidence) if seen.status == SUCCEEDED and objection(evidence, seen)]
    if not wrong:
        return None
    wanted = expected_sequence(evidence, int(wrong[0].order or 0))
    return Advice(
        f"For order {wrong[0].order} the result is {wrong[0].sequence}; it should be {wanted}: one number more than "
        "the order says.",
        "Begin with [0, 1] in each goal, and append the sum of the last two numbers until there are order + 1.",
    )


def feedback_missing(evidence: Evidence) -> Advice | None:
    """Goals succeed without feedback."""
    good = [seen for seen in good_goals(evidence) if seen.status == SUCCEEDED]
    if not good or any(seen.feedback for seen in good):
        return None
    return Advice(
        "The goals succeed, but no feedback comes.",
        "In the loop of the execute callback, fill a Fibonacci.Feedback() and call "
        "goal_handle.publish_feedback(feedback).",
    )


def wrong_feedback(evidence: Evidence) -> Advice | None:
    """Feedback comes, and does not grow by one number."""
    wrong = [
        text
        for seen in good_goals(evidence)
        if seen.feedback and (text := feedback_objection(evidence, seen))
    ]
    if not wrong:
        return None
    return Advice(
        f"The feedback does not grow by one number each time ({wrong[0]}).",
        "Publish once for each number that you append, with all numbers found so far in partial_sequence.",
    )


def cancel_refused(evidence: Evidence) -> Advice | None:
    """The cancel request was answered with no."""
    long = goal(evidence.part(GOALS), LONG)
    if long.cancel_accepted is not False or long.unread >= MANY or _quick(long):
        return None
    return Advice(
        "Your server refuses to cancel: without a cancel_callback, rclpy rejects every cancel request.",
        "Give the ActionServer a cancel_callback that returns CancelResponse.ACCEPT, and look at "
        "goal_handle.is_cancel_requested in the loop.",
    )


def cancel_refused_on_its_way(evidence: Evidence) -> Advice | None:
    """The same, of a goal that had not ended: whether the request came in time has no part in it."""
    return None if goal(evidence.part(GOALS), LONG).cancelled_too_late else cancel_refused(evidence)


def cancel_not_read(evidence: Evidence) -> Advice | None:
    """The goal goes on and the cancel request is not answered."""
    long = goal(evidence.part(GOALS), LONG)
    if long.cancel_accepted or long.unread < MANY or _quick(long):
        return None
    return Advice(
        "Your server works on and does not even read the cancel request: the one thread that spins the node is busy "
        "with the execute callback.",
        "Spin the node with a MultiThreadedExecutor (executor.add_node(node), executor.spin()), so that another thread "
        "can take the request.",
    )


def cancel_ignored(evidence: Evidence) -> Advice | None:
    """The cancel was accepted and the goal went on."""
    long = goal(evidence.part(GOALS), LONG)
    if not long.cancel_accepted or long.status == CANCELED:
        return None
    return Advice(
        f"Your server accepted the cancel request, but the goal was not canceled (status {status_text(long.status)}).",
        "In each turn of the loop look at goal_handle.is_cancel_requested; where it is True call "
        "goal_handle.canceled() and return the result so far.",
    )


def _quick(long: Goal) -> bool:
    return long.seconds is not None and long.seconds < AT_ONCE


def done_at_once(evidence: Evidence) -> Advice | None:
    """The long goal was over before anybody could cancel it."""
    long = goal(evidence.part(GOALS), LONG)
    quick = long.status == SUCCEEDED and not long.cancel_accepted and _quick(long)
    if not quick and not (long.status == CANCELED and takes_no_time(evidence.part(GOALS))):
        return None
    return Advice(
        f"A goal of order {long.order} was done at once: there was no time to cancel it.",
        "Take some time for each number, for example time.sleep(0.5): an action is for work that takes long.",
    )


def partial_result_missing(evidence: Evidence) -> Advice | None:
    """Canceled, and the part that was computed does not come back."""
    long = goal(evidence.part(GOALS), LONG)
    if long.status != CANCELED or is_the_part(evidence, long):
        return None
    return Advice(
        f"The canceled goal ended with {long.sequence or 'an empty result'}, although {long.before_cancel} numbers had "
        "been found.",
        "After goal_handle.canceled(), return a result whose sequence holds the numbers found so far.",
    )


def bad_order_accepted(evidence: Evidence) -> Advice | None:
    """A bad order is taken on."""
    taken = [
        seen for seen in all_goals(evidence.part(BAD_ORDERS)) if seen.order != LAST_ORDER and seen.accepted
    ]
    if not taken or not counts(evidence).passed:
        return None
    why = (
        "there is no sequence of a negative length"
        if int(taken[0].order or 0) < 0
        else (f"from order {FIRST_TOO_LARGE} on, the last number does not fit into an int32")
    )
    return Advice(
        f"Your server accepted a goal of order {taken[0].order}, which it cannot serve: {why}.",
        "Give the ActionServer a goal_callback that looks at goal_request.order and returns GoalResponse.REJECT for "
        "such orders.",
    )


def only_bad_orders(evidence: Evidence) -> Advice | None:
    """All else is right."""
    rest = (counts, gives_feedback, serves_two_at_once, lets_cancel)
    return bad_order_accepted(evidence) if all(judge(evidence).passed for judge in rest) else None


MISTAKES = (
    Mistake("two_servers", two_servers, certain=True),
    Mistake("result_missing", result_missing, certain=True),
    # Before any crash: an order that is too large ends in one.
    Mistake("bad_order_accepted", only_bad_orders, certain=True),
    *common.CRASHES,
    common.endpoint_name("action_server"),
    common.message_type("action_server"),
    Mistake("exception_in_callback", exception_in_execute, certain=True),
    *common.OTHER_CRASHES,
    Mistake("goal_rejected", goal_rejected, certain=True),
    Mistake("goal_not_succeeded", goal_not_succeeded, certain=True),
    Mistake("field_typo", result_never_filled, certain=True),
    Mistake("goals_mixed_up", goals_mixed_up),
    Mistake("wrong_sequence", wrong_sequence, certain=True),
    Mistake("feedback_missing", feedback_missing),
    Mistake("wrong_feedback", wrong_feedback),
    Mistake("cancel_not_accepted", cancel_refused_on_its_way, certain=True),
    Mistake("cancel_not_accepted", cancel_refused),
    Mistake("cancel_not_accepted", cancel_not_read),
    Mistake("done_at_once", done_at_once),
    Mistake("cancel_ignored", cancel_ignored),
    Mistake("partial_result_missing", partial_result_missing, certain=True),
    Mistake("bad_order_accepted", bad_order_accepted, certain=True),
    *HANGS,
    common.never_spun("action_server"),
    common.went_deaf("action_server"),
    *common.NOTHING_THERE,
)
"""Most telling first."""
