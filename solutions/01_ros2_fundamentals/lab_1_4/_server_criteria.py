"""The criteria of Lab 1.4 for an action server, decided from what the judge's action client has seen."""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING

from lab_1_4._goals import (
    AGAIN,
    ALONE,
    BAD_ORDERS,
    BESIDE,
    FIRST_TOO_LARGE,
    GOALS,
    LAST_ORDER,
    LONG,
    LONG_ALONE,
    NEXT,
    ORDERS,
    ROUNDS_LEFT,
    TWINS,
    YOUNGER,
    FibonacciGoal,
    all_goals,
    canceled_later,
    ended_by_a_younger,
    expected_sequence,
    feedback_objection,
    feedback_slip,
    first_two,
    goal,
    goals_alone,
    is_beginning,
    is_wrong_when_large,
    objection,
    paced_goals_alone,
    takes_no_time,
    tells_at_the_end,
    to_be_canceled,
)

from autograder.kit.mistakes.common_mistakes import misfit, servers
from autograder.kit.model import Finding
from autograder.kit.outcomes import CANCELED, status_text

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from autograder.kit.evidence import Evidence, Part


ENDED = "the program ended by itself"


def of_one_server(judge: Callable[[Evidence], Finding]) -> Callable[[Evidence], Finding]:
    """A criterion about goals that fails where two servers share the action's name, or the server ended by itself.

    Each goal reaches two servers, and chance decides whose answers the client takes. Chance decides, too, which goals
    come before a program ends.
    """

    @functools.wraps(judge)
    def judged(evidence: Evidence) -> Finding:
        found, count, part = judge(evidence), servers(evidence.main), evidence.main
        if part.ending is not None and not part.traceback:
            return Finding(False, found.expected, ENDED)
        return found if count < 2 else Finding(False, found.expected, f"each goal reached {count} servers")

    return judged


def serves(evidence: Evidence) -> Finding:
    """One action server of the right name and type, and it accepts a goal.

    A server whose callback raised an exception was there, so the exception costs only the goals.
    """
    name, type_name = evidence.reference.only("action_server")
    part, expected = evidence.main, f"one server of {name} ({type_name}) that accepts goals"
    if wrong := misfit(evidence, "action_server"):
        return Finding(False, expected, wrong)
    first = goal(part, ALONE)
    raised = first.order is not None and bool(part.traceback)
    if part.ending is not None and not raised:
        return Finding(False, expected, ENDED)
    seen = "it accepts goals" if first.accepted else objection(evidence, first)
    return Finding(bool(first.accepted) or raised, expected, seen)


@of_one_server
def counts(evidence: Evidence) -> Finding:
    """Every good goal that has the server to itself succeeds with the reference's sequence.

    So does the large goal, as far as the numbers go that come when the others are over.
    """
    beside = goal(evidence.part(GOALS), BESIDE)
    goals = [*goals_alone(evidence), *([beside] if is_wrong_when_large(evidence, beside) else [])]
    wrong = [_told(evidence, seen, text) for seen in goals if (text := objection(evidence, seen))]
    expected = f"succeeds with {expected_sequence(evidence, max(ORDERS))} for order {max(ORDERS)}, and so on"
    return _all_right(goals, wrong, expected)


def _all_right(goals: Sequence[FibonacciGoal], wrong: Sequence[str], expected: str) -> Finding:
    seen = wrong[0] if wrong else "it does" if goals else "no goal was sent"
    return Finding(bool(goals) and not wrong, expected, seen)


def _told(evidence: Evidence, seen: FibonacciGoal, fault: str) -> str:
    """Return a fault, with a remark on the goal if the same order was right before."""
    return f"at the end, once more {fault}" if seen == goal(evidence.part(GOALS), AGAIN) else fault


@of_one_server
def gives_feedback(evidence: Evidence) -> Finding:
    """The feedback of a goal that has the server to itself grows by one number, while the server works.

    So does that of the large goal, if two at once do not disturb each other.
    """
    goals, beside = paced_goals_alone(evidence), goal(evidence.part(GOALS), BESIDE)
    if beside.over and not (objection(evidence, beside) or feedback_slip(evidence, beside)):
        goals.append(beside)
    wrong = [_told(evidence, seen, text) for seen in goals if (text := feedback_objection(evidence, seen))]
    if tells_at_the_end(evidence.part(GOALS)):
        wrong.append("all of it came at once, when the work was done")
    return _all_right(goals, wrong, "one more number in each feedback message")


@of_one_server
def serves_two_at_once(evidence: Evidence) -> Finding:
    """Two equal goals at once are right, and so are those beside a goal that is canceled, which ends as it should."""
    part = evidence.part(GOALS)
    twins, beside = [goal(part, number) for number in TWINS], goal(part, BESIDE)
    wrong = [text for one in twins if one.order is not None and (text := objection(evidence, one))]
    others = (beside, goal(part, NEXT))
    wrong += [
        text for one in others if one.order is not None and (text := fault_beside_another(evidence, one))
    ]
    wrong += [
        objection(evidence, one)
        for one in (goal(part, LONG_ALONE), goal(part, YOUNGER))
        if one.accepted is False
    ]
    wrong += [
        f"order {one.order}, which was to be canceled: status {status_text(one.status)}"
        for one in goes_on_beside_another(part)
    ]
    if (older := ended_by_a_younger(part)) is not None:
        wrong.insert(0, f"the older goal ended as {status_text(older.status)} when the younger one came")
    asked = beside.order is not None
    seen = wrong[0] if wrong else "both are right" if asked else "not reached"
    return Finding(asked and not wrong, "each of two goals at once ends with its own sequence", seen)


def goes_on_beside_another(part: Part) -> list[FibonacciGoal]:
    """The goals that the server agreed to cancel and went on with, although it can cancel a goal.

    Of the first one that is known only if a goal that had the server to itself was canceled afterwards.
    """
    first, later = goal(part, LONG), canceled_later(part)
    known = [first, *later] if any(one.status == CANCELED for one in (first, *later)) else []
    return [one for one in known if one.cancel_accepted and one.status != CANCELED]


def fault_beside_another(evidence: Evidence, seen: FibonacciGoal) -> str:
    fault = objection(evidence, seen) or feedback_slip(evidence, seen)
    return "" if is_wrong_when_large(evidence, seen) else fault


@of_one_server
def lets_cancel(evidence: Evidence) -> Finding:
    """A cancel is accepted, ends the goal soon, and the part that was computed comes back."""
    long = to_be_canceled(evidence)
    expected = "the cancel is accepted, the goal ends as CANCELED with the numbers found so far"
    seen = cancel_objection(evidence, long) or _refused_later(evidence)
    return Finding(not seen, expected, seen or f"CANCELED with {len(long.sequence)} numbers")


def _refused_later(evidence: Evidence) -> str:
    # Of a quick server, a goal may be over when a busy judge asks to cancel it.
    later = [one for one in canceled_later(evidence.part(GOALS)) if not one.cancelled_too_late]
    if any(one.cancel_accepted is False for one in later):
        return "a later cancel request was not accepted"
    unanswered = any(one.cancel_accepted is None and one.status is None for one in later)
    return "a later cancel request was not answered" if unanswered else ""


def cancel_objection(evidence: Evidence, long: FibonacciGoal) -> str:
    """The fault in how a goal was canceled, in words; empty if there is none."""
    if long.order is None:
        return "not reached"
    if not long.accepted:
        return f"order {long.order} was rejected" if long.accepted is False else "the goal was not answered"
    if long.cancel_accepted is None and long.status is None:
        return f"the cancel request was not answered; {long.unread} feedback messages came after it"
    if not long.cancel_accepted:
        return f"the cancel request was not accepted; status {status_text(long.status)}"
    if long.status != CANCELED:
        return f"the cancel was accepted, then: status {status_text(long.status)}"
    if worked_on(evidence, long):
        late = long.sent_after(long.cancel_answered_at)
        return f"CANCELED with {len(long.sequence)} numbers, {late} feedback messages after the cancel"
    if not is_the_part(evidence, long):
        return f"CANCELED with {long.sequence}"
    return (
        "only as the machine is busy: it counts without a pause"
        if takes_no_time(evidence.part(GOALS))
        else ""
    )


def is_the_part(evidence: Evidence, long: FibonacciGoal) -> bool:
    """True if a canceled goal came back with what had been computed."""
    return len(long.sequence) >= max(2, long.told_before) and is_beginning(long.sequence, first_two(evidence))


def worked_on(evidence: Evidence, long: FibonacciGoal) -> bool:
    """True if the server went on with a goal for more than a round after it had agreed to cancel it."""
    extra = len(expected_sequence(evidence, min(ORDERS))) - min(ORDERS)
    told = max(map(len, long.partials), default=0)
    tells = told > 0 and gives_feedback(evidence).passed
    return (
        long.sent_after(long.cancel_answered_at) > ROUNDS_LEFT
        or len(long.sequence) >= int(long.order or 0) + extra
        or (tells and len(long.sequence) > told + ROUNDS_LEFT)
    )


@of_one_server
def refuses_bad_orders(evidence: Evidence) -> Finding:
    """Negative and too large orders are refused, and two good goals after them come to an end, whichever that is."""
    part, expected = (
        evidence.part(BAD_ORDERS),
        f"rejects negative orders and {FIRST_TOO_LARGE} or more, and lives on",
    )
    sent = all_goals(part)
    bad, last = [s for s in sent if s.order != LAST_ORDER], [s for s in sent if s.order == LAST_ORDER]
    taken = [seen for seen in bad if seen.accepted is not False]
    if taken:
        how = "accepted" if taken[0].accepted else "not answered"
        return Finding(False, expected, f"order {taken[0].order} was {how}")
    if not last:
        return Finding(False, expected, "not reached")
    lost = next((objection(evidence, seen) for seen in last if not (seen.accepted and seen.over)), "")
    return Finding(not lost, expected, f"after the rejected goals, {lost}" if lost else "it does")
