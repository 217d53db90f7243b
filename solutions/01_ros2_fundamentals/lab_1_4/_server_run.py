"""How the judge drives an action server of Lab 1.4: as its client, in two runs."""

from __future__ import annotations

from typing import TYPE_CHECKING

from lab_1_4._goals import (
    BAD_ORDERS,
    FIRST_TOO_LARGE,
    GOALS,
    LAST_ORDER,
    LONG,
    LONG_ORDER,
    LONGER,
    ORDERS,
    PACED,
    SMALLEST,
)

from autograder.kit.goals_seen import Goal, goal
from autograder.kit.model import Bench, Pace

if TYPE_CHECKING:
    from collections.abc import Callable

    from autograder.kit.counterparts import ActionCaller
    from autograder.kit.evidence import Part

CANCEL_AFTER = 2
"""Feedback messages after which the cancel is asked for."""
THREADS = 4
"""Threads that spin a notebook's class: with one, no cancel is read while a goal is executed."""

SLEEP_FACTOR = {Pace.FAST: 0.04, Pace.REAL_TIME: 1.0}
"""What a sleep of a notebook's server is multiplied with: it may pace its work as it likes, and nobody need wait."""

SERVER_LIMIT = {Pace.FAST: 3.0, Pace.REAL_TIME: 6.0}
"""Seconds in which a server that is on the graph must be matched with the judge's client."""
QUIET = {Pace.FAST: 3.0, Pace.REAL_TIME: 8.0}
"""Seconds without any event after which something is taken not to come."""
GOAL_LIMIT = 60.0
"""Seconds in which a goal must have ended, however much happens."""
CANCEL_LIMIT = {Pace.FAST: 4.0, Pace.REAL_TIME: 8.0}
"""Seconds in which a cancel must have been honoured; a server looks once for each number."""

AFTERMATH = 0.5
"""Seconds in which a server that has died of the cancel must have said so."""


def scenario(bench: Bench) -> None:
    """One run with good goals, one of which is canceled; one run with bad ones."""
    if run(bench, GOALS, send_good_goals):
        run(bench, BAD_ORDERS, send_bad_goals)


def run(bench: Bench, name: str, goals: Callable[[Bench, ActionCaller], bool]) -> bool:
    """Start the server and send goals; whether it was there to take them."""
    action, type_name = bench.reference.only("action_server")
    bench.part(name)
    caller = bench.call_action(action, type_name)
    bench.start(threads=THREADS, sleep_factor=SLEEP_FACTOR[bench.pace])
    there = bench.await_endpoint("action_server", action)
    bench.release()
    there = there and caller.await_server(SERVER_LIMIT[bench.pace])
    if there and not goals(bench, caller):
        bench.note_whether_it_spins()
        bench.note_where_it_hangs()
    bench.stop()
    return there


def send_good_goals(bench: Bench, caller: ActionCaller) -> bool:
    """A goal alone, two at once, many small ones, one that is canceled; False as soon as one does not end."""
    alone, smaller = bench.random.sample(ORDERS, 2)
    if not all(
        ended(bench, *[caller.send_goal(order=order) for order in batch])
        for batch in ((alone,), bench.random.sample((smaller, LONGER), 2), *SMALLEST)
    ):
        return False
    caller.send_goal(order=LONG_ORDER)
    bench.wait_until(lambda e: _may_cancel(e.main), QUIET[bench.pace])
    caller.cancel(LONG)
    if not bench.wait_until(lambda e: _cancel_is_over(goal(e.main, LONG)), CANCEL_LIMIT[bench.pace]):
        # A MultiThreadedExecutor raises what a callback of its raised only when it has something else to do.
        bench.settle()
        bench.await_end(AFTERMATH)
    return True


def _may_cancel(part: Part) -> bool:
    seen = goal(part, LONG)
    # A server that has left out feedback may send none now, and the goal would be over before that is known.
    said_all = all(len(goal(part, n).feedback) >= int(goal(part, n).order or 0) - 2 for n in PACED)
    return len(seen.feedback) >= CANCEL_AFTER or seen.over or (bool(seen.accepted) and not said_all)


def _cancel_is_over(seen: Goal) -> bool:
    return seen.cancel_accepted is False or (seen.over and seen.cancel_accepted is not None)


def send_bad_goals(bench: Bench, caller: ActionCaller) -> bool:
    """Orders that must be refused, up to the first that is not; then a good one."""
    orders = (-1, -bench.random.randint(2, 99), FIRST_TOO_LARGE, bench.random.randint(60, 999))
    for number, order in enumerate(orders):
        caller.send_goal(order=order)
        if not bench.wait_until(lambda e, n=number: goal(e.main, n).accepted is not None, QUIET[bench.pace]):  # type: ignore[misc]
            return False
        if bench.wait_until(lambda e, n=number: bool(goal(e.main, n).accepted), 0.0):  # type: ignore[misc]
            return True
    return ended(bench, caller.send_goal(order=LAST_ORDER))


def ended(bench: Bench, *numbers: int) -> bool:
    """Wait until goals have ended."""
    return bench.wait_until(
        lambda e: all(goal(e.main, number).over for number in numbers), GOAL_LIMIT, quiet=QUIET[bench.pace]
    )
