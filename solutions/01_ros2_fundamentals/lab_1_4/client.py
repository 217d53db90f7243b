"""Lab 1.4: an action client that sends a goal, shows feedback and tells how the goal ended.

The judge is the server. Its numbers are no Fibonacci numbers, and its result is another one than its last feedback, so
that only a client that shows what it gets can be right. It comes late once, refuses a goal, aborts another, and in the
last part it is not there.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from lab_1_4._client_mistakes import MISTAKES

from autograder.kit.giving_up import GIVE_UP_LIMIT, LATENESS, PATIENCE, await_it, remark
from autograder.kit.goal_reports import (
    ABORTED,
    ABSENT,
    LATE,
    MANY_REQUESTS,
    NOT_AWAITED,
    REFUSED,
    aborted_as_seen,
    asked_for,
    given_up,
    goals_as_seen,
    left_at_once,
    miscalled,
    refused_as_seen,
    reports_result,
    unshown_feedback,
)
from autograder.kit.lateness import (
    ANSWERS_SOON,
    SOON,
    TRIES,
    answers_late,
    hold_back,
    was_patient,
    was_patient_with_an_answer,
)
from autograder.kit.model import ActionCounterpart, Bench, Criterion, Exercise, Finding, Look

if TYPE_CHECKING:
    from collections.abc import Mapping

    from autograder.kit.evidence import Evidence

ORDERS = (11, 30)
"""The smallest and the largest order that the client is given."""
FEEDBACKS = 14
"""Feedback messages of the goal that succeeds: enough for a client that goes deaf after a while to be found out."""
PACE = {Look.FAST: 0.5, Look.REAL_TIME: 1.5}
"""Seconds at most in which a client shows a feedback message before the next one is sent."""
HASTE = 0.2
"""What that is multiplied with once it was used up: who shows nothing is not waited for again and again."""
GOAL_LIMIT = 15.0
"""Seconds in which a goal must arrive once the client is on the graph."""
END_LIMIT = {Look.FAST: 3.0, Look.REAL_TIME: 8.0}
"""Seconds in which a client must ask for the result, must have reported it, must have ended after a refusal."""
AFTERMATH = 1.0
"""Seconds in which a client that has reported may end, or say more."""
PATIENCES = (4.0, 9.0)
"""The smallest and the largest number of seconds that a notebook's function is told to wait, whatever comes."""


def scenario(bench: Bench) -> None:
    """Four runs: a goal that succeeds at a late server, then one refused, one aborted, no server, in any order."""
    if late(bench):
        for run in bench.random.sample((refused, aborted, unserved), 3):
            run(bench)


def begin(bench: Bench, name: str) -> dict[str, Any]:
    """Begin a part; what the subject is to be started with."""
    inputs = {"order": bench.random.randint(*ORDERS), PATIENCE: round(bench.random.uniform(*PATIENCES), 1)}
    bench.part(name, **inputs)
    return inputs


def start(bench: Bench, inputs: Mapping[str, Any], *, spare: float = 0.0) -> None:
    """Start the subject; a notebook leaves out ``spare`` seconds of its waiting for the server."""
    bench.start(inputs["order"], patience_sec=inputs[PATIENCE], spare=spare)


def late(bench: Bench) -> bool:
    """One run with a server that comes late; whether the subject came to an end of its work."""
    inputs = begin(bench, LATE)
    held = answers_late(bench)
    done = meets_late_server(bench, inputs, LATENESS, held)
    if done and not asked_for(bench.seen()) and was_patient(bench.seen()):
        bench.again()
        done = meets_late_server(bench, inputs, SOON, held)
    for _ in range(TRIES):
        seen = bench.seen()
        if not done or seen.of("result_request") or not was_patient_with_an_answer(seen, ["goal"]):
            break
        bench.again()
        done = meets_late_server(bench, inputs, SOON, ANSWERS_SOON)
    bench.stop()
    return done


def meets_late_server(bench: Bench, inputs: Mapping[str, Any], lateness: float, held: float) -> bool:
    """Start the subject and let it wait for its server; whether it came to an end of its work.

    Args:
        bench: Where it happens.
        inputs: What the subject is started with.
        lateness: Seconds after its client at which the server comes.
        held: Seconds that the answer to the goal is held back.
    """
    action, type_name = bench.reference.only("action_client")
    start(bench, inputs, spare=lateness)
    if not bench.await_endpoint("action_client", action):
        return bench.await_end(0.0)
    bench.let_wait(lateness)
    server = bench.serve_action(action, type_name, goal_answer_takes=held)
    return works_on_a_goal(bench, server, "succeeded", FEEDBACKS)


def meets_server(bench: Bench, inputs: Mapping[str, Any], *, accept: bool = True) -> ActionCounterpart:
    """Start the subject and serve as soon as the judge has met it.

    Where the server was there before, a client may know it first, and the goal of one that ends at once would reach the
    judge or not, as it happens.

    Args:
        bench: Where it happens.
        inputs: What the subject is started with.
        accept: Whether goals are accepted.
    """
    action, type_name = bench.reference.only("action_client")
    start(bench, inputs)
    bench.await_endpoint("action_client", action)
    return bench.serve_action(action, type_name, accept_goal=accept)


def aborted(bench: Bench) -> None:
    """One run with a goal that is aborted."""
    inputs = begin(bench, ABORTED)
    works_on_a_goal(bench, meets_server(bench, inputs), "aborted", 1)
    bench.stop()


def works_on_a_goal(bench: Bench, server: ActionCounterpart, status: str, feedbacks: int) -> bool:
    """Send feedback for the subject's goal and end it; whether the subject came to an end of its work."""
    # As many as an int32 allows, so that nobody can say them all.
    numbers = sorted(bench.random.sample(range(10**8, 10**9), feedbacks + 2))
    result = sorted(bench.random.sample(range(10**9, 2 * 10**9), 4))
    done = server.await_goal(GOAL_LIMIT)
    if done:
        pace = PACE[bench.look]
        for count in range(3, 3 + feedbacks):
            server.send_feedback(partial_sequence=numbers[:count])
            if not bench.wait_until(lambda seen: not unshown_feedback(seen.main), pace):
                pace = PACE[bench.look] * HASTE
        server.await_result_request(END_LIMIT[bench.look])
        hold_back(bench, "result_request")
        server.finish(status, sequence=result)
        done = bench.wait_until(is_done, END_LIMIT[bench.look])
    if done or bench.await_end(0.0):
        bench.await_end(AFTERMATH)
        return True
    bench.note_whether_it_spins()
    bench.note_where_it_hangs()
    return False


def is_done(evidence: Evidence) -> bool:
    """Whether the subject has ended or, as a program may, has said something of the result and goes on spinning."""
    part = evidence.main
    result = part.first("result")
    return part.ending is not None or (result is not None and bool(part.said(after=result)))


def refused(bench: Bench) -> None:
    """One run with a server that refuses every goal."""
    inputs = begin(bench, REFUSED)
    if meets_server(bench, inputs, accept=False).await_goal(GOAL_LIMIT):
        bench.await_end(END_LIMIT[bench.look])
    bench.stop()


def unserved(bench: Bench) -> None:
    """One run without a server."""
    action, _ = bench.reference.only("action_client")
    inputs = begin(bench, ABSENT)
    start(bench, inputs, spare=GIVE_UP_LIMIT)
    bench.await_endpoint("action_client", action)
    await_it(bench)
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
    if sent and left_at_once(part, "result"):
        # How much came before it ended is the machine's doing.
        return Finding(False, f"all {FEEDBACKS} feedback messages", "it ended before its goal did")
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
    asked = len(part.of("result_request"))
    if asked == 0:
        return Finding(False, expected, "never asked for the result")
    if asked > MANY_REQUESTS:
        return Finding(False, expected, f"asked for the result {asked} times")
    said = part.said(after=result)
    if wrong := miscalled(part):
        return Finding(False, expected, f"“{wrong}” about a goal that succeeded")
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
    part = evidence.part(LATE)
    wrong = "" if asked_for(part) else "no goal came"
    if not wrong and left_at_once(part):
        wrong = NOT_AWAITED
    return Finding(not wrong, "waits, then sends its goal", wrong or "it did")


def ends_without_a_server(evidence: Evidence) -> Finding:
    """Without a server it ends by itself and says so, or says again and again that it waits."""
    wrong = given_up(evidence)
    return Finding(not wrong, "says so and ends by itself", wrong or "it says so")


def may_wait_on(evidence: Evidence) -> str:
    """A word on limits for a client that waits on."""
    return remark(evidence.part(ABSENT))


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
    remarks=(may_wait_on,),
    roles=("action_client",),
    limit=180.0,
    arguments="the order",
    sample_arguments=(10,),
)
