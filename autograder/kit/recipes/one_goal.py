"""The recipe for an action client that sends one goal: the judge is the server, and behaves differently in each run.

A client passes only if it shows what it receives, because it cannot guess the judge's numbers: they are not Fibonacci
numbers and not sorted, one of them occurs twice, and the result differs from the last feedback. The server comes a
little late in one run, refuses the goal in another, aborts it in a third, and does not exist in the last. In this last
run, the client should show that it waits long enough. If it does not, the first run is made again with a server that
comes as late as the task allows.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from autograder.kit.bench import Bench, Pace
from autograder.kit.evidence import Part
from autograder.kit.giving_up import (
    LATENESS,
    PATIENCE,
    await_it,
    drawn_patience,
    patience_without_a_server,
)
from autograder.kit.goal_reports import (
    ABORTED,
    ABSENT,
    FEEDBACKS,
    LATE,
    REFUSED,
    REJECTED,
    WAIT,
    aborted_as_seen,
    refused_as_seen,
    unshown_feedback,
)
from autograder.kit.lateness import (
    ANSWERS_LATE,
    ANSWERS_SOON,
    SOON,
    again_while,
    answers_late,
    await_goal,
    called_before_server,
    hold_back,
    late_at_first,
    may_be_impatient,
    meets_late_action,
    meets_present,
    missed_a_result,
    second_lateness,
)
from autograder.kit.mistakes import common_mistakes as common
from autograder.kit.mistakes import goal_mistakes as goals
from autograder.kit.mistakes import unfinished
from autograder.kit.mistakes.hangs import HANGS
from autograder.kit.recipes.action_client import ActionClient

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from autograder.kit.counterparts import ActionCounterpart
    from autograder.kit.evidence import Evidence

ORDERS = {LATE: (41, 46), REFUSED: (-9, -1), ABORTED: (0, 0), ABSENT: (11, 30)}
"""For each part, the smallest and the largest order that the client may be given. Negative numbers and 0 are valid."""
SHOWN_WITHIN = {Pace.FAST: 0.5, Pace.REAL_TIME: 1.5}
"""The time in seconds after which the next feedback message is sent even if the client has not shown the last one."""
HASTE = {Pace.FAST: 0.1, Pace.REAL_TIME: 0.075}
"""A shorter limit instead of :data:`SHOWN_WITHIN`, in seconds, after the client has failed to show a message. It is
chosen so that the goal's result comes after about 3.5 s, between the 3 and the 5 seconds that many clients wait.
"""
AT_PACE = 3
"""The number of feedback messages at the end that are sent at the pace of the lab's server, unless the client has shown
all messages at once. They are needed to judge fairly a client that shows the newest message from a timer.
"""
LAB_PACE = 0.5
"""The time in seconds between two feedback messages at the pace of the lab's server, by the client's clock."""
PROMPT = 0.1
"""A client that has shown all messages within this many seconds keeps up, and is sent the next one at once."""
RESULT = 28
"""The minimum length of a result. It is long enough to detect a client that shows only the first ten or twenty numbers.

For a larger order, the result has one number more than the order, as in the lab.
"""
GOAL_LIMIT = 15.0
"""Time limit in seconds for a goal to arrive once the client is on the graph."""
END_LIMIT = {Pace.FAST: 3.0, Pace.REAL_TIME: 8.0}
"""The time limit in seconds for each of these steps: the client requests the result, reports it, or ends after a
refusal.
"""
AFTERMATH = 1.0
"""After a client has reported the end of its goal, the judge waits this many seconds for the client to end or print
more.
"""


def _scenario(bench: Bench) -> None:
    """Make four runs: first a late server; then, in random order, a refused goal, an aborted goal, and no server.

    If a student waits for the card, the run without a server comes first, because it is the shortest.
    """
    runs, impatient = bench.random.sample((refused, aborted, unserved), 3), False
    if bench.is_waited_for:
        runs.remove(unserved)
        unserved(bench, Part(LATE))
        impatient = may_be_impatient(bench)
    inputs = _begin(bench, LATE)
    again = second_lateness([part for part in bench.before or () if part.name != LATE], "goal")
    lateness = LATENESS if impatient else late_at_first(bench)
    if not _late(bench, inputs, lateness, again) or called_before_server(bench.seen()):
        bench.leave_out(ABSENT)
        return
    first, served = bench.seen(), list[Part]()
    for run in runs:
        run(bench, first)
        served.append(bench.seen())
        impatient = may_be_impatient(bench) if run is unserved else impatient
    again = second_lateness(served, "goal")
    clock = bench.pace is Pace.FAST and again > SOON
    if (impatient or clock) and lateness < LATENESS and first.of("goal"):
        bench.again(LATE)
        _late(bench, inputs, LATENESS, again, answers_late(bench))


def _begin(bench: Bench, name: str) -> dict[str, Any]:
    """Begin a part, and return the inputs with which the subject is started."""
    order = bench.random.randint(*ORDERS[name])
    inputs = {
        # A program gets no negative order, because -3 on a command line could be mistaken for an option.
        "order": order if bench.in_a_cell else abs(order),
        PATIENCE: patience_without_a_server(bench, name) if name == ABSENT else drawn_patience(bench),
    }
    bench.part(name, **inputs)
    return inputs


def _start(bench: Bench, inputs: Mapping[str, Any]) -> None:
    """Start the subject."""
    bench.start(inputs["order"], patience_sec=inputs[PATIENCE])


def _late(
    bench: Bench, inputs: Mapping[str, Any], lateness: float, again: float, held: float = ANSWERS_LATE
) -> bool:
    """Make one run with a late server. Return True if the subject finished its work.

    Args:
        lateness: The delay of the server, in seconds.
        again: The delay in a further run, in seconds.
        held: The delay of the answer to the goal, in seconds. It is as long as allowed even if a student waits for the
            check, because only a long delay shows whether a client's time limit is long enough.
    """

    def meet(seconds: float, answer: float) -> bool:
        return _meets_late_server(bench, inputs, seconds, answer, SHOWN_WITHIN)

    def in_haste() -> bool:
        return _meets_late_server(bench, inputs, SOON, ANSWERS_SOON, HASTE)

    done = meets_late_action(bench, meet, ["goal"], lateness, held, again)
    done = again_while(bench, missed_a_result, in_haste, done)
    bench.stop()
    return done


def _meets_late_server(
    bench: Bench, inputs: Mapping[str, Any], lateness: float, held: float, shown_within: Mapping[Pace, float]
) -> bool:
    """Start the subject, and its server some seconds later. Return True if the subject finished its work.

    Args:
        lateness: The delay in seconds between the start of the client and of the server.
        held: The number of seconds for which the answer to the goal is held back.
        shown_within: The time limit in seconds, by pace, for showing each feedback message, until the client fails to
            show one.
    """
    action, type_name = bench.reference.only("action_client")
    _start(bench, inputs)
    if not bench.await_endpoint("action_client", action):
        return bench.await_end(0.0)
    bench.let_wait(lateness)
    server = bench.serve_action(action, type_name, goal_answer_takes=held)
    return works_on_a_goal(bench, server, "succeeded", FEEDBACKS, shown_within[bench.pace])


def meets_server(
    bench: Bench, begin_it: Callable[[], object], *, prepared: bool = False, late: float = 0.0, **how: Any
) -> ActionCounterpart:
    """Start the subject, and its server once the judge has discovered the subject. Return the server.

    If the server existed earlier, a client might discover it first. Then chance would decide whether the goal of a
    client that ends at once reaches the judge.

    Args:
        prepared: True to start the server before the subject.
        late: The delay of the server in seconds, once the subject is there.
        how: How the server answers: see :meth:`autograder.kit.bench.Bench.serve_action`.
    """
    action, type_name = bench.reference.only("action_client")
    server = bench.serve_action(action, type_name, **how) if prepared else None
    begin_it()
    if bench.await_endpoint("action_client", action) and late:
        bench.let_wait(late)
    return server or bench.serve_action(action, type_name, **how)


def aborted(bench: Bench, first: Part) -> None:
    """Make one run in which the goal is aborted. ``first`` is the run with the late server."""
    if bench.before and not aborted_as_seen(bench.before) and bench.keep(ABORTED):
        return
    inputs = _begin(bench, ABORTED)

    def meet() -> bool:
        server = meets_server(bench, lambda: _start(bench, inputs), prepared=needs_no_search(bench, first))
        return works_on_a_goal(bench, server, "aborted", 1, HASTE[bench.pace])

    meets_present(bench, meet, "goal", known=bool(first.of("goal")))
    bench.stop()


def needs_no_search(bench: Bench, first: Part) -> bool:
    """Return True if the server may start before the subject: a notebook's function known to wait for answers."""
    return bench.in_a_cell and bool(first.of("result_request"))


def works_on_a_goal(
    bench: Bench, server: ActionCounterpart, status: str, feedbacks: int, shown_within: float
) -> bool:
    """Send feedback for the subject's goal, then end the goal. Return True if the subject finished its work.

    Args:
        status: The status with which the goal ends, such as ``"succeeded"``.
        feedbacks: The number of feedback messages to send first.
        shown_within: The time limit in seconds for showing each message, until the client fails to show one.
    """
    # The numbers come from such a large range that a subject cannot print all of them.
    numbers = bench.random.sample(range(10**8, 10**9), feedbacks + 2)
    newest = bench.random.sample(range(10**8, 10**9), feedbacks)
    length = max(RESULT, bench.seen().inputs["order"] + 1)
    result = bench.random.sample(range(10**9, 2 * 10**9), length - 1)
    # One number occurs twice, to detect clients that drop repeated numbers. The second time it is the last number but
    # one, because a missing first or last number would be noticed even without a repetition.
    result.insert(-1, result[1])

    def all_shown() -> bool:
        return not unshown_feedback(bench.seen())

    done = await_goal(bench, server, GOAL_LIMIT)
    if done:
        # Send feedback only after the client has read the answer to its goal and requests the result. If the answer and
        # the feedback came together, chance would decide which of them a client receives that ends after one event.
        server.await_result_request(SHOWN_WITHIN[bench.pace])
        action, _ = bench.reference.only("action_client")
        for count, last in enumerate(newest, start=2):
            # The last number of each message occurs in no other message, so each message that a client does not show is
            # noticed.
            server.send_feedback(partial_sequence=[*numbers[:count], last])
            left = feedbacks + 1 - count
            if 0 < left < AT_PACE:
                bench.run_time(PROMPT, until=all_shown)
                if not all_shown():
                    bench.pass_time(LAB_PACE - PROMPT, "action_client", action)
            elif not bench.wait_until(lambda _: all_shown(), shown_within):
                shown_within = HASTE[bench.pace]
                # Wait until a client on a busy machine has processed the messages in its queue, which holds only ten.
                bench.settle()
        server.await_result_request(END_LIMIT[bench.pace])
        hold_back(bench, "result_request")
        server.finish(status, sequence=result)
        done = bench.wait_until(_is_done, END_LIMIT[bench.pace])
    if done or bench.await_end(0.0):
        bench.await_end(AFTERMATH)
        return True
    bench.note_whether_it_spins()
    bench.note_where_it_hangs()
    return False


def _is_done(evidence: Evidence) -> bool:
    """Return True if the subject has ended, or has printed something since its result was sent.

    It need not have ended, because a program may report part of the result and then keep spinning.
    """
    part = evidence.main
    result = part.first("result")
    return part.ending is not None or (result is not None and bool(part.said(after=result)))


def refused(bench: Bench, first: Part) -> None:
    """Make one run with a server that refuses every goal. ``first`` is the run with the late server."""
    if bench.before and not refused_as_seen(bench.before) and bench.keep(REFUSED):
        return
    inputs = _begin(bench, REFUSED)
    refuse(
        bench,
        lambda: _start(bench, inputs),
        known=bool(first.of("goal")),
        prepared=needs_no_search(bench, first),
        may_stay=first.ending is None,
    )


def refuse(
    bench: Bench,
    begin_it: Callable[[], object],
    *,
    known: bool,
    prepared: bool = False,
    may_stay: bool = False,
) -> None:
    """Refuse the subject's goal, and end the part.

    Args:
        known: True if the subject has already sent a goal.
        prepared: True to start the server before the subject.
        may_stay: True if the subject may keep running after the refusal. Then the judge waits only until the subject
            has reported the refusal, and a moment longer.
    """

    def reported(seen: Evidence) -> bool:
        return may_stay and bool(REJECTED.lines(seen.main))

    def meet() -> bool:
        server = meets_server(bench, begin_it, accept_goal=False, prepared=prepared)
        if server.await_goal(GOAL_LIMIT) and bench.wait_until(reported, END_LIMIT[bench.pace]):
            bench.await_end(AFTERMATH)
        return bench.await_end(0.0)

    meets_present(bench, meet, "goal", known=known)
    bench.stop()


def unserved(bench: Bench, _: Part) -> None:
    """Make one run without a server."""
    if bench.keep(ABSENT):
        return
    action, _ = bench.reference.only("action_client")
    inputs = _begin(bench, ABSENT)
    _start(bench, inputs)
    bench.await_endpoint("action_client", action)
    await_it(bench)
    bench.stop()


_WHAT_IS_SAID = (
    goals.RESULT_OF_REJECTED_GOAL,
    goals.RESULT_NOT_REQUESTED,
    goals.RESULT_NOT_REPORTED,
    goals.REFUSAL_NOT_REPORTED,
    goals.ABORT_NOT_REPORTED,
    WAIT.silent_end(),
)
"""Mistakes in what a client requests and reports. They are certain if the client ended by itself in every part."""


def sends_goals() -> ActionClient:
    """Return the recipe for a client that sends one goal of a given order and reports how it ended."""
    return ActionClient(
        _scenario,
        goals.WRONG_ORDER,
        unfinished.NOT_BEGUN,
        unfinished.USAGE_MESSAGE,
        WAIT.too_short(),
        goals.ENDED_TOO_EARLY,
        WAIT.for_nobody(),
        WAIT.patience_not_kept(),
        WAIT.for_ever(),
        *(replace(hang, certain=True) for hang in HANGS),
        common.AWAITS_IN_VAIN,
        common.went_deaf("action_client"),
        # This mistake is never certain: a client on a busy machine may not have read its feedback when the result
        # comes.
        goals.FEEDBACK_NOT_SHOWN,
        *map(common.only_if_ended, _WHAT_IS_SAID),
        goals.STAYS_AFTER_REFUSAL,
        *_WHAT_IS_SAID,
        goals.NOT_RETURNED,
    )
