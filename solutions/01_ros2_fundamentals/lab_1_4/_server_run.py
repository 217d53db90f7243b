"""The scenario of Lab 1.4's action server: the judge is its client, in two runs."""

from __future__ import annotations

from statistics import median
from typing import TYPE_CHECKING

from lab_1_4._goals import (
    AGAIN,
    ALONE,
    BAD_ORDERS,
    BESIDE,
    CANCELED_ALONE,
    FIRST_TOO_LARGE,
    GOALS,
    LARGE_ORDER,
    LAST_ORDER,
    LONG,
    LONG_ALONE,
    LONG_ORDER,
    NEXT,
    NEXT_ORDER,
    ORDERS,
    PACED,
    ROUNDS_LEFT,
    SMALLEST,
    TWINS,
    YOUNGER,
    FibonacciGoal,
    died_of_two,
    ended_by_a_younger,
    goal,
    is_told_at_the_end,
)

from autograder.kit.model import Bench, Pace
from autograder.kit.outcomes import ABORTED, CANCELED

if TYPE_CHECKING:
    from collections.abc import Callable

    from autograder.kit.counterparts import ActionCaller
    from autograder.kit.evidence import Evidence

CANCEL_AFTER = 10
"""Feedback messages after which the cancel is asked for: three rounds or more before a server looks again that does so
with every fifth or tenth number only."""
THREADS = 4
"""Threads that spin a notebook's class: with one, no cancel is read while a goal is executed."""

SERVER_LIMIT = {Pace.FAST: 3.0, Pace.REAL_TIME: 6.0}
"""Seconds in which a server that is on the graph must be matched with the judge's client."""
QUIET = {Pace.FAST: 3.0, Pace.REAL_TIME: 8.0}
"""Seconds without any event after which something is taken not to come."""
SILENCE = {Pace.FAST: 3.0, Pace.REAL_TIME: 16.0}
"""The same while a server may be busy with a goal of the large order, and tell nothing of it."""
GOAL_LIMIT = 100.0
"""Seconds in which a goal must have ended, however much happens."""
CANCEL_LIMIT = {Pace.FAST: 4.0, Pace.REAL_TIME: 8.0}
"""Seconds in which a cancel must have been honoured; a server looks once for each number."""
UNREAD = 6
"""If a server sends so many feedback messages without an answer to the cancel request, it reads no request while it
works on the goal. Messages are counted, not seconds, so that the load of the machine changes nothing.
"""

LEAST, GREATEST = -(2**31), 2**31 - 1
"""The smallest and the largest order that fits into the goal."""

AFTERMATH = 0.5
"""Seconds in which a server that has died of the cancel must have said so."""


def scenario(bench: Bench) -> None:
    """One run with good goals, one of which is canceled; one run with bad ones.

    If two goals at once are too much for the server, it gets a goal to cancel alone, in a run of its own.
    """
    if run(bench, GOALS, send_good_goals):
        if died_of_two(bench.seen()):
            run(bench, CANCELED_ALONE, cancel_one)
        run(bench, BAD_ORDERS, send_bad_goals)


def cancel_one(bench: Bench, caller: ActionCaller) -> bool:
    """Cancel a goal that has a new server to itself."""
    _cancel_another(bench, caller, LONG_ALONE, after=CANCEL_AFTER)
    return True


def run(bench: Bench, name: str, goals: Callable[[Bench, ActionCaller], bool]) -> bool:
    """Start the server and send goals; whether it was there to take them."""
    action, type_name = bench.reference.only("action_server")
    bench.part(name)
    caller = bench.call_action(action, type_name)
    bench.start(threads=THREADS)
    there = bench.await_endpoint("action_server", action)
    bench.release()
    there = there and caller.await_server(SERVER_LIMIT[bench.pace])
    if there and not goals(bench, caller):
        bench.note_whether_it_spins()
        bench.note_where_it_hangs()
    bench.stop()
    return there


def send_good_goals(bench: Bench, caller: ActionCaller) -> bool:
    """A goal alone, many small ones, one that is canceled beside a younger one; False as soon as one does not end.

    There are never more than two goals at once: a server may have no threads for a third one.
    """
    order = bench.random.choice(ORDERS)
    if not one_by_one(bench, caller, order, *SMALLEST):
        return False
    if not ended(bench, *[caller.send_goal(order=LAST_ORDER) for _ in TWINS]):
        return False
    caller.send_goal(order=LONG_ORDER)
    _await_feedback(bench, LONG, 1)
    _wait_half_a_round(bench)
    caller.send_goal(order=LARGE_ORDER)
    _await_feedback(bench, LONG, CANCEL_AFTER)
    if bench.wait_until(lambda e: ended_by_a_younger(e.main) is not None, 0.0):
        if not ended(bench, BESIDE, quiet=SILENCE[bench.pace]) or not _once_more(bench, caller, order):
            return False
        # A policy of one goal at a time must not cost the points for canceling.
        _cancel_another(bench, caller, LONG_ALONE, after=CANCEL_AFTER)
        return True
    caller.cancel(LONG)
    honoured = _await_cancel(bench, LONG)
    if goal(bench.seen(), BESIDE).accepted is None:
        return True  # one thread, and it is busy: the younger goal has not been read either
    if _canceled_in_time(bench):
        _wait_half_a_round(bench)
        _cancel_another(bench, caller, YOUNGER, after=1)
    if not ended(bench, BESIDE, quiet=SILENCE[bench.pace]):
        return False
    # A notebook's node ends with the exception that has aborted a goal: no other goal must lose by that.
    if goal(bench.seen(), BESIDE).status == ABORTED and bench.await_end(AFTERMATH):
        return False
    if not _once_more(bench, caller, order):
        return False
    # Results may overtake feedback on their way to a busy judge.
    bench.wait_until(lambda e: all(_tells_all(goal(e.main, n)) for n in PACED), GOAL_LIMIT, quiet=AFTERMATH)
    if not honoured:
        # If two threads work on two goals, the cancel request is read only when one of them is done.
        _await_cancel(bench, LONG)
    first = goal(bench.seen(), LONG)
    if first.cancel_accepted and first.status != CANCELED and ended(bench, LONG):
        # It agreed to cancel and went on: is that so alone, too?
        _cancel_another(bench, caller, LONG_ALONE, after=1)
    elif _canceled_in_time(bench):
        _cancel_another(bench, caller, LONG_ALONE, after=1, then=NEXT_ORDER)
    return True


def _once_more(bench: Bench, caller: ActionCaller, order: int) -> bool:
    """Send the first goal again; whether it ended."""
    return ended(bench, caller.send_goal(AGAIN, order=order))


def _canceled_in_time(bench: Bench) -> bool:
    first = goal(bench.seen(), LONG)
    in_time = first.status == CANCELED and first.sent_after(first.cancel_answered_at) <= ROUNDS_LEFT
    return in_time and bool(goal(bench.seen(), BESIDE).accepted)


def _cancel_another(
    bench: Bench, caller: ActionCaller, number: int, *, after: int, then: int | None = None
) -> None:
    """Send the largest goal again, and cancel it.

    Args:
        bench: The bench of the scenario.
        caller: The judge's client.
        number: The number of the goal.
        after: Feedback messages after which the cancel is asked for.
        then: The order of a goal that is sent as soon as the server has agreed, before it looks at the request.
    """
    caller.send_goal(number, order=LONG_ORDER)
    _await_feedback(bench, number, after)
    if goal(bench.seen(), number).over:
        return
    caller.cancel(number)
    if then is not None:
        bench.wait_until(lambda e: goal(e.main, number).cancel_accepted is not None, QUIET[bench.pace])
        if not ended(bench, caller.send_goal(NEXT, order=then)):
            return
    _await_cancel(bench, number)


def _wait_half_a_round(bench: Bench) -> None:
    """Wait for half of the time that a number takes: then two goals are looked after in turn, and not by chance."""
    pauses = goal(bench.seen(), ALONE).pauses
    bench.wait_until(lambda _: False, median(pauses) / 2 if pauses else 0.0)


def one_by_one(bench: Bench, caller: ActionCaller, *orders: int) -> bool:
    """Send each goal when the one before has ended; whether all did."""
    return all(ended(bench, caller.send_goal(order=order)) for order in orders)


def _await_feedback(bench: Bench, number: int, messages: int) -> None:
    """Wait until a goal has this much feedback, or waiting is useless."""

    def has_told(evidence: Evidence) -> bool:
        seen, others = goal(evidence.main, number), [goal(evidence.main, other) for other in PACED]
        # A server that has left out feedback, or sent it at the end, may send none now, and the goal would be over
        # before that is known.
        silent = any(one.over and (not _tells_all(one) or is_told_at_the_end(one)) for one in others)
        return len(seen.feedback) >= messages or seen.over or (bool(seen.accepted) and silent)

    bench.wait_until(has_told, GOAL_LIMIT, quiet=QUIET[bench.pace])


def _tells_all(seen: FibonacciGoal) -> bool:
    """True if there is feedback for each number but the first two and the last."""
    return len(seen.feedback) >= int(seen.order or 0) - 2


def _await_cancel(bench: Bench, number: int) -> bool:
    """Wait until the server has honoured or refused the cancel request, or reads none; False if it reads none."""

    def settled(evidence: Evidence) -> bool:
        seen = goal(evidence.main, number)
        return _cancel_is_over(seen) or (seen.cancel_accepted is None and seen.unread >= UNREAD)

    bench.wait_until(settled, CANCEL_LIMIT[bench.pace])
    if bench.wait_until(lambda e: _cancel_is_over(goal(e.main, number)), 0.0):
        return True
    # A MultiThreadedExecutor raises what a callback of its raised only when it has something else to do.
    bench.settle()
    bench.await_end(AFTERMATH)
    return False


def _cancel_is_over(seen: FibonacciGoal) -> bool:
    return seen.cancel_accepted is False or (seen.over and seen.cancel_accepted is not None)


def send_bad_goals(bench: Bench, caller: ActionCaller) -> bool:
    """Orders that must be refused, up to the first that is not; then a good one, twice."""
    orders = (
        *(-1, -bench.random.randint(2, 99), LEAST),
        *(FIRST_TOO_LARGE, bench.random.randint(60, 999), GREATEST),
    )
    for number, order in enumerate(orders):
        caller.send_goal(order=order)
        if not bench.wait_until(lambda e, n=number: goal(e.main, n).accepted is not None, QUIET[bench.pace]):  # type: ignore[misc]
            return False
        if bench.wait_until(lambda e, n=number: bool(goal(e.main, n).accepted), 0.0):  # type: ignore[misc]
            return True
    return one_by_one(bench, caller, LAST_ORDER, LAST_ORDER)


def ended(bench: Bench, *numbers: int, quiet: float | None = None) -> bool:
    """Wait until goals have ended, as long as anything happens in ``quiet`` seconds."""
    return bench.wait_until(
        lambda e: all(goal(e.main, number).over for number in numbers),
        GOAL_LIMIT,
        quiet=quiet or QUIET[bench.pace],
    )
