"""The goals that Lab 1.4 sends to an action server, and in which order."""

from __future__ import annotations

from typing import TYPE_CHECKING

from autograder.kit.oracle.goal_sender import AFTERMATH, QUIET, GoalSender
from autograder.kit.oracle.goals_seen import ROUNDS_LEFT
from autograder.kit.outcomes import ABORTED, CANCELED, SentGoal, goal
from autograder.kit.recipes.own_scenario import meet

if TYPE_CHECKING:
    from collections.abc import Callable

    from autograder.kit import Part
    from autograder.kit.bench import Bench

GOALS, BAD_ORDERS, CANCELED_ALONE = "goals", "bad orders", "a goal alone is canceled"
"""The runs. The third one is made only if two goals at once end the server before it is asked to cancel one."""
ORDERS = (5, 4)
"""Orders of the goal alone, which is sent again after the cancel; the seed decides. Either has enough numbers to show
feedback that leaves some out."""
LARGE_ORDER = 37
"""The order of the goal that goes on beside the others. Its last numbers fit neither into 16 bits nor into the 24 of a
short float, and are not those of the golden ratio with a few digits."""
SMALLEST = (1, 0, 1, 0, 1, 1, 1, 1, 0, 1)
"""Orders that take no time, one after another: the edge of what there is, and enough for a server that dies of many."""
LAST_ORDER = 2
"""The order of the two goals after the bad ones, and of two equal ones that are sent at once."""
NEXT_ORDER = 3
"""The order of the goal that is sent as soon as the server has agreed to cancel the one before it."""
LONG_ORDER, FIRST_TOO_LARGE = 46, 47
"""The order of the goals that are canceled, and the first one whose last number does not fit into an int32."""
BAD = (-1, -(2**31), FIRST_TOO_LARGE, 2**31 - 1)
"""Orders that the server must refuse; others are drawn."""
ALONE, TINY, TWINS = 0, range(1, 11), range(11, 13)
LONG, BESIDE, AGAIN, LONG_ALONE, NEXT, YOUNGER = range(13, 19)
"""The goals of the first run by their numbers."""
PACED = (ALONE, BESIDE, AGAIN)
"""The goals that take time and are to succeed."""
CANCEL_AFTER = 10
"""Feedback messages after which the cancel is asked for: three rounds or more before a server looks again that does so
with every fifth or tenth number only."""


def ended_by_a_younger(part: Part) -> SentGoal | None:
    """Return the goal that the server ended for a newer one, before a cancel was requested; None if there is none.

    A server may do so, like the official example of a single goal.
    """
    older, younger = goal(part, LONG), goal(part, BESIDE)
    if older.status not in (ABORTED, CANCELED) or not younger.accepted:
        return None
    kinds = [(e.kind, e.data["goal"]) for e in part.events if e.data.get("goal") in (LONG, BESIDE)]
    before = [kind for kind, _ in kinds[: kinds.index(("result_heard", LONG))]]
    return older if before.count("goal_sent") == 2 and "cancel_sent" not in before else None


def died_of_two(part: Part) -> bool:
    """True if the server ended with an exception when two goals were sent at once, before any cancel."""
    crashed = bool(part.traceback) and part.ending is not None
    return crashed and goal(part, TWINS[0]).request is not None and not part.of("cancel_sent")


def scenario(bench: Bench) -> None:
    """One run with good goals, one of which is canceled; one run with bad ones.

    If two goals at once are too much for the server, it gets a goal to cancel alone, in a run of its own. A node that
    no longer answers at all, not even about its parameters, gets no bad goals: it would reject none.
    """
    if _run(bench, GOALS, _send_good_goals) and not bench.seen().of("unanswered"):
        if died_of_two(bench.seen()):
            _run(bench, CANCELED_ALONE, lambda sender: _cancel(sender, LONG_ALONE, after=CANCEL_AFTER))
        _run(bench, BAD_ORDERS, _send_bad_goals)


def _run(bench: Bench, name: str, goals: Callable[[GoalSender], bool]) -> bool:
    # There is feedback for each number but the first two and the last.
    due = lambda sent: int(sent.request["order"]) - 2  # noqa: E731
    return meet(
        bench, name, lambda met: goals(GoalSender(bench, met.action_callers[0], due)), only="action_server"
    )


def _send_good_goals(sender: GoalSender) -> bool:
    """Send a goal alone, many small ones, one that is canceled beside a younger one. Return False if one does not end.

    There are never more than two goals at once: a server may have no threads for a third one.
    """
    bench, order = sender.bench, sender.bench.random.choice(ORDERS)
    if not all(sender.finish(sender.send(order=one)) for one in (order, *SMALLEST)):
        return False
    if not sender.finish(*[sender.send(order=LAST_ORDER) for _ in TWINS]):
        return False
    # A server that sent one message where more were due may send none now before its goal is over.
    rounds = 1 if len(sender[ALONE].feedback) > 1 else 0
    sender.send(order=LONG_ORDER)
    if sender.await_answer(LONG):
        sender.await_feedback(LONG, rounds)
    sender.wait_half_a_round(ALONE)
    sender.send(order=LARGE_ORDER)
    sender.await_feedback(LONG, rounds * CANCEL_AFTER)
    one_at_a_time = ended_by_a_younger(bench.seen()) is not None
    if not one_at_a_time:
        sender.cancel(LONG)
        if sender[BESIDE].accepted is None:
            return True  # one thread, and it is busy: the younger goal has not been read either
        if _canceled_in_time(sender):
            sender.wait_half_a_round(ALONE)
            _cancel(sender, YOUNGER)
    # A server may be busy with this goal for long, and tell nothing of it.
    if not sender.finish(BESIDE, quiet=2 * QUIET[bench.pace]):
        return False
    # A notebook's node ends with the exception that has aborted a goal: no other goal must lose by that.
    if sender[BESIDE].status == ABORTED and bench.await_end(AFTERMATH):
        return False
    if not one_at_a_time:
        # If two threads work on two goals, the cancel request is read only when one of them is done.
        sender.await_cancel(LONG)
        if bench.seen().ending is not None:
            return True  # no other goal must lose by an exception that the canceled one has raised
    if not sender.finish(sender.send(AGAIN, order=order)):
        return False
    if one_at_a_time:
        # A policy of one goal at a time must not cost the points for canceling.
        return _cancel(sender, LONG_ALONE, after=CANCEL_AFTER)
    if sender[LONG].was_canceled_too_late:
        sender.finish(LONG)
    if sender[LONG].was_over_when_canceled and not sender[LONG].is_quick:
        # A busy judge may ask when the goal is over. A goal alone, and asked for at its first number, has longer to go.
        return _cancel(sender, LONG_ALONE)
    if _canceled_in_time(sender):
        return _cancel(sender, LONG_ALONE, then=lambda: sender.finish(sender.send(NEXT, order=NEXT_ORDER)))
    # It agreed to cancel and went on: is that so alone, too?
    if sender[LONG].cancel_accepted and sender[LONG].status != CANCELED and sender.finish(LONG):
        _cancel(sender, LONG_ALONE)
    return True


def _canceled_in_time(sender: GoalSender) -> bool:
    first = sender[LONG]
    in_time = first.status == CANCELED and first.sent_after(first.cancel_answered_at) <= ROUNDS_LEFT
    return in_time and bool(sender[BESIDE].accepted)


def _cancel(
    sender: GoalSender, number: int, after: int = 1, then: Callable[[], object] | None = None
) -> bool:
    sender.send(number, order=LONG_ORDER)
    sender.cancel(number, after=after, then=then)
    return True


def _send_bad_goals(sender: GoalSender) -> bool:
    """Send orders that must be refused, up to the first that is not; then a good one, twice."""
    random = sender.bench.random
    for order in (BAD[0], -random.randint(2, 99), *BAD[1:3], random.randint(60, 999), BAD[3]):
        number = sender.send(order=order)
        if not sender.await_answer(number):
            return False
        if sender[number].accepted:
            return True
    return all(sender.finish(sender.send(order=LAST_ORDER)) for _ in range(2))
