"""Lab 1.4: an action server that counts Fibonacci numbers, with feedback, cancel and refusal.

The judge is the client. All in one run of the server: a goal alone, two goals at once, a goal that is canceled, orders
that must be refused, and one more goal to see that the node is still alive. A server may pace its work as it likes, so
orders are small.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from autograder.exercises.fibonacci_goals import (
    ALONE,
    BAD_ORDERS,
    FIRST_OF_TWO,
    FIRST_TOO_LARGE,
    GOALS,
    LAST_ORDER,
    LONG,
    ORDERS,
    SECOND_OF_TWO,
    Goal,
    goal,
)
from autograder.exercises.fibonacci_server_criteria import (
    counts,
    gives_feedback,
    lets_cancel,
    refuses_bad_orders,
    serves,
    serves_two_at_once,
)
from autograder.exercises.fibonacci_server_mistakes import MISTAKES
from autograder.exercises.model import Bench, Criterion, Exercise, Look

if TYPE_CHECKING:
    from collections.abc import Callable

    from autograder.exercises.callers import ActionCaller

LONG_ORDER = {Look.FAST: 20, Look.REAL_TIME: 40}
"""The order of the goal that is canceled: long enough that a server that works at all is still at it."""
CANCEL_AFTER = 2
"""Feedback messages after which the cancel is asked for."""
THREADS = 4
"""Threads that spin a notebook's class: with one, no cancel is read while a goal is executed."""

HURRY = {Look.FAST: 0.1, Look.REAL_TIME: 1.0}
"""What a sleep of a notebook's server is multiplied with: it may pace its work as it likes, and nobody need wait."""

SERVER_LIMIT = {Look.FAST: 3.0, Look.REAL_TIME: 6.0}
"""Seconds in which a server that is on the graph must be matched with the judge's client."""
QUIET = {Look.FAST: 3.0, Look.REAL_TIME: 8.0}
"""Seconds without any event after which something is taken not to come."""
GOAL_LIMIT = 30.0
"""Seconds in which a small goal must have ended, however much happens."""
CANCEL_LIMIT = {Look.FAST: 4.0, Look.REAL_TIME: 8.0}
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
    bench.start(threads=THREADS, hurry=HURRY[bench.look])
    there = bench.await_endpoint("action_server", action)
    bench.release()
    there = there and caller.await_server(SERVER_LIMIT[bench.look])
    if there and not goals(bench, caller):
        bench.note_whether_it_spins()
        bench.note_where_it_hangs()
    bench.stop()
    return there


def send_good_goals(bench: Bench, caller: ActionCaller) -> bool:
    """A goal alone, two at once, one that is canceled; False as soon as one does not end as it should."""
    alone, first, second = bench.random.sample(ORDERS, 3)
    caller.send_goal(order=alone)
    if not ended(bench, ALONE):
        return False
    caller.send_goal(order=first)
    caller.send_goal(order=second)
    if not ended(bench, FIRST_OF_TWO, SECOND_OF_TWO):
        return False
    caller.send_goal(order=LONG_ORDER[bench.look])
    bench.wait_until(lambda e: _may_cancel(goal(e.main, LONG)), QUIET[bench.look])
    caller.cancel(LONG)
    if not bench.wait_until(lambda e: _cancel_is_over(goal(e.main, LONG)), CANCEL_LIMIT[bench.look]):
        # A MultiThreadedExecutor raises what a callback of its raised only when it has something else to do.
        bench.settle()
        bench.await_end(AFTERMATH)
    return True


def _may_cancel(seen: Goal) -> bool:
    return len(seen.feedback) >= CANCEL_AFTER or seen.over


def _cancel_is_over(seen: Goal) -> bool:
    return seen.cancel_accepted is False or (seen.over and seen.cancel_accepted is not None)


def send_bad_goals(bench: Bench, caller: ActionCaller) -> bool:
    """Orders that must be refused, up to the first that is not; then a good one."""
    orders = (-bench.random.randint(1, 99), FIRST_TOO_LARGE, bench.random.randint(60, 999))
    for number, order in enumerate(orders):
        caller.send_goal(order=order)
        if not bench.wait_until(lambda e, n=number: goal(e.main, n).accepted is not None, QUIET[bench.look]):  # type: ignore[misc]
            return False
        if bench.wait_until(lambda e, n=number: bool(goal(e.main, n).accepted), 0.0):  # type: ignore[misc]
            return True
    return ended(bench, caller.send_goal(order=LAST_ORDER))


def ended(bench: Bench, *numbers: int) -> bool:
    """Wait until goals have ended."""
    return bench.wait_until(
        lambda e: all(goal(e.main, number).over for number in numbers), GOAL_LIMIT, quiet=QUIET[bench.look]
    )


EXERCISE = Exercise(
    id="lab_1_4.server",
    title="Lab 1.4 · An action server that counts",
    task="Serve the action fibonacci: feedback for each number, cancel at any time, bad orders refused.",
    scenario=scenario,
    criteria=(
        Criterion("action", "Serves fibonacci, with the right type", 1, serves),
        Criterion("sequence", "Succeeds with the right numbers", 3, counts),
        Criterion("feedback", "Sends feedback that grows by one number", 1, gives_feedback),
        Criterion("two", "Serves two goals at once", 1, serves_two_at_once),
        Criterion("cancel", "Lets a goal be canceled", 2, lets_cancel),
        Criterion("refuse", "Refuses bad orders and lives on", 2, refuses_bad_orders),
    ),
    mistakes=MISTAKES,
    roles=("action_server",),
    limit=180.0,
)
