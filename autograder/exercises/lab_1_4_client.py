"""Lab 1.4: an action client that sends a goal, shows feedback and tells how the goal ended.

The judge is the server. Its numbers are no Fibonacci numbers, and its result is another one than its last feedback, so
that only a client that shows what it gets can be right. It comes late once, refuses a goal, aborts another, and in the
last part it is not there.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from autograder.exercises.fibonacci_client_mistakes import MISTAKES
from autograder.exercises.fibonacci_reports import (
    ABORTED,
    ABSENT,
    GIVE_UP_LIMIT,
    LATE,
    REFUSED,
    aborted_as_seen,
    asked_for,
    given_up,
    goals_as_seen,
    refused_as_seen,
    reports_result,
    unshown_feedback,
)
from autograder.exercises.model import Bench, Criterion, Exercise, Finding, Look

if TYPE_CHECKING:
    from autograder.exercises.evidence import Evidence

ORDERS = (11, 30)
"""The smallest and the largest order that the client is given."""
FEEDBACKS = 4
"""Feedback messages of the goal that succeeds."""
PACE = {Look.FAST: 0.5, Look.REAL_TIME: 1.5}
"""Seconds at most in which a client shows a feedback message before the next one is sent."""
GOAL_LIMIT = 15.0
"""Seconds in which a goal must arrive once the client is on the graph."""
END_LIMIT = {Look.FAST: 3.0, Look.REAL_TIME: 8.0}
"""Seconds in which a client must ask for the result, must have reported it, must have ended after a refusal."""
AFTERMATH = 1.0
"""Seconds in which a client that has reported may end, or say more."""
SHORT_PATIENCE = 0.15
"""Seconds that a notebook's function is told to wait for the server where there is none."""


def scenario(bench: Bench) -> None:
    """Four runs: a goal that succeeds at a late server, a refused one, an aborted one, no server."""
    if served(bench, LATE, "succeeded") and refused(bench) and served(bench, ABORTED, "aborted"):
        unserved(bench)


def served(bench: Bench, name: str, status: str) -> bool:
    """One run with a goal that is accepted; whether the subject came to an end of its work."""
    action, type_name = bench.reference.only("action_client")
    # As many as an int32 allows, so that nobody can say them all.
    numbers = sorted(bench.random.sample(range(10**8, 10**9), FEEDBACKS + 2))
    result = sorted(bench.random.sample(range(10**9, 2 * 10**9), FEEDBACKS))
    order = bench.random.randint(*ORDERS)
    bench.part(name, order=order)
    if name != LATE:
        server = bench.serve_action(action, type_name)
    bench.start(order)
    if name == LATE:
        if not bench.await_endpoint("action_client", action):
            ended = bench.await_end(0.0)
            bench.stop()
            return ended
        server = bench.serve_action(action, type_name)
    done = server.await_goal(GOAL_LIMIT)
    if done:
        for count in range(3, 3 + (FEEDBACKS if name == LATE else 1)):
            server.send_feedback(partial_sequence=numbers[:count])
            bench.wait_until(lambda seen: not unshown_feedback(seen.main), PACE[bench.look])
        server.await_result_request(END_LIMIT[bench.look])
        server.finish(status, sequence=result)
        done = bench.wait_until(is_done, END_LIMIT[bench.look])
    if done or bench.await_end(0.0):
        bench.await_end(AFTERMATH)
        done = True
    else:
        bench.note_whether_it_spins()
        bench.note_where_it_hangs()
    bench.stop()
    return done


def is_done(evidence: Evidence) -> bool:
    """Whether the subject has ended or, as a program may, has said something of the result and goes on spinning."""
    part = evidence.main
    result = part.first("result")
    return part.ending is not None or (result is not None and bool(part.said(after=result)))


def refused(bench: Bench) -> bool:
    """One run with a server that refuses every goal."""
    action, type_name = bench.reference.only("action_client")
    order = bench.random.randint(*ORDERS)
    bench.part(REFUSED, order=order)
    server = bench.serve_action(action, type_name, accept_goal=False)
    bench.start(order)
    if server.await_goal(GOAL_LIMIT):
        bench.await_end(END_LIMIT[bench.look])
    bench.stop()
    return True


def unserved(bench: Bench) -> None:
    """One run without a server."""
    action, _ = bench.reference.only("action_client")
    order = bench.random.randint(*ORDERS)
    if bench.keep(ABSENT):
        return
    bench.part(ABSENT, order=order)
    bench.start(order, patience_sec=SHORT_PATIENCE)
    bench.await_endpoint("action_client", action)
    bench.await_end(GIVE_UP_LIMIT)
    bench.stop()


def sends_the_goal(evidence: Evidence) -> Finding:
    """In each run one goal, of the order that it was given."""
    wrong = goals_as_seen(evidence)
    expected = "one goal of the given order, in each run"
    return Finding(not wrong, expected, wrong or expected)


def shows_feedback(evidence: Evidence) -> Finding:
    """Every feedback message is logged or printed."""
    part = evidence.part(LATE)
    sent, missing = part.of("feedback"), unshown_feedback(part)
    shown = len(sent) - len(missing)
    return Finding(
        bool(sent) and not missing,
        f"all {FEEDBACKS} feedback messages",
        f"{shown} of them" if sent else "none was sent",
    )


def reports_the_result(evidence: Evidence) -> Finding:
    """The sequence of the result is said or returned."""
    part = evidence.part(LATE)
    result = part.first("result")
    expected = f"{result.data['fields']['sequence']} said at the end" if result else "the result's sequence"
    if result is None:
        return Finding(False, expected, "no goal to give a result for")
    if part.first("result_request") is None:
        return Finding(False, expected, "never asked for the result")
    said = part.said(after=result)
    return Finding(
        reports_result(part), expected, f"“{said[-1]}”" if said else "nothing was said after the result"
    )


def tells_of_refusal(evidence: Evidence) -> Finding:
    """A refused goal is told, no result is asked for, and the client ends."""
    wrong = refused_as_seen(evidence)
    return Finding(not wrong, "says that the goal was refused, and ends", wrong or "it did")


def tells_of_abort(evidence: Evidence) -> Finding:
    """An aborted goal is told, by the status or in words."""
    wrong = aborted_as_seen(evidence)
    return Finding(not wrong, "says that the goal was ABORTED (6)", wrong or "it did")


def waits_for_the_server(evidence: Evidence) -> Finding:
    """With a server that comes late it sends its goal all the same."""
    done = bool(asked_for(evidence.part(LATE)))
    return Finding(done, "waits, then sends its goal", "it did" if done else "no goal came")


def ends_without_a_server(evidence: Evidence) -> Finding:
    """Without a server it ends by itself and says so."""
    wrong = given_up(evidence)
    return Finding(not wrong, "says so and ends by itself", wrong or "it did")


EXERCISE = Exercise(
    id="lab_1_4.client",
    title="Lab 1.4 · A client that sends a goal",
    task="Send a goal to the action fibonacci, show its feedback, report its result and how it ended.",
    scenario=scenario,
    criteria=(
        Criterion("goal", "Sends one goal of the given order", 2, sends_the_goal),
        Criterion("feedback", "Shows each feedback message", 2, shows_feedback),
        Criterion("result", "Reports the result", 2, reports_the_result),
        Criterion("refused", "Says when the goal is refused", 1, tells_of_refusal),
        Criterion("aborted", "Says when the goal is aborted", 1, tells_of_abort),
        Criterion("late", "Waits for a server that comes late", 1, waits_for_the_server),
        Criterion("limit", "Ends clearly when there is no server", 1, ends_without_a_server),
    ),
    mistakes=MISTAKES,
    roles=("action_client",),
    limit=180.0,
    arguments="the order",
    sample_arguments=(10,),
)
