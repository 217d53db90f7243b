"""The judge's answers to a client that cancels: it honours that, refuses it, agrees and fails, or takes no goal.

The judge is the action server. In a first part it comes late and cancels as it is asked to; in a second one the goal
succeeds all the same, so that a client that only claims "canceled" is told from one that looked at the status. There
the judge refuses to cancel. Of a client that never asked for the result it accepts the request, since only the status
on its topic tells then. In a third part the judge agrees to cancel, and the goal is aborted: that the server agreed
does not say how the goal ended. In a fourth one the goal itself is refused.

The judge waits for nothing that cannot change the verdict any more. The look in real time repeats only those runs in
which time may have played a part, and its server comes sooner if the client has already waited for a late one. Once the
moment for the request is over, the remaining feedback comes quickly. A client that does not say how its first goal
ended has lost the points for the ends of all goals.

In real time, the feedback of the first run comes several times as fast as that of the second: no clock, only a count,
says in both when the third message has come.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from exercise_1_3._cancel_evidence import (
    AGREED,
    CANCEL_REFUSED,
    FIRST_FEEDBACK,
    HONOURED,
    LAST_FEEDBACK,
    OUTCOMES,
    Request,
    after_result,
    goals,
    in_the_window,
    request_of,
    was_asked_at_once,
)

from autograder.kit.giving_up import LATENESS
from autograder.kit.goal_reports import REFUSED, refused_as_seen
from autograder.kit.lateness import SOON, await_goal, hold_back, meets_late_action, meets_present
from autograder.kit.model import Bench, Pace
from autograder.kit.recipes.action_client import needs_no_search, refuse

if TYPE_CHECKING:
    from autograder.kit.counterparts import ActionCounterpart
    from autograder.kit.evidence import Evidence, Part

WITHOUT_CANCEL = 19
"""Feedback messages that are sent to a client that does not cancel: all that a goal of order 20 has."""
CLOCKS = 2.5
"""Seconds after the last feedback in which a client that goes by a clock may still ask, far too late: the card then
says so."""
WITH_LATE = 14
"""Feedback messages that are sent in all to one that does, to see that those after its request are not acted on."""
FEW_LATE = 3
"""Feedback messages after the request in the second run, which is about the end."""
AT_A_TIME = 3
"""Late feedback messages that are sent before the client has to have taken them; its queue holds ten."""
ENDS = {HONOURED: "canceled", CANCEL_REFUSED: "succeeded", AGREED: "aborted"}
"""The end of a goal after a cancel request, by the name of the part; any other goal succeeds."""
LAB_TIME = 1.5
"""Seconds of its own time in which a client must not ask once more; the lab's server takes less to end the goal."""

FIRST_STATUS = 2
"""The goal's status is published before this feedback message: some time after its acceptance, before any cancel is
due.
"""
FEEDBACK_GAP = 0.03
"""Seconds between two feedback messages in a fast look, outside the window in which a cancel is expected."""
QUICK, SLOW = (0.47, 0.52), (2.35, 2.45)
"""The ranges of the same seconds in real time, in the first run and in the second. The lab's server is as quick as the
first.

The window of the quick run, from the third message to the sixth, ends before that of the slow run begins, even counted
from the client's start. So a request that comes a fixed time after anything is outside of one of the two windows.
"""
FIRST_AFTER = 0.25
"""Seconds from the answer to the goal to its first feedback message in real time."""
LATE_GAP = 0.2
"""Seconds between two feedback messages in real time after the request."""
WINDOW_WAIT = 0.2
"""Seconds that a fast look waits for a cancel after each feedback message inside that window."""
PROMPT = 0.05
"""Seconds of wall time in which a client that counts feedback has asked to cancel, once its executor has turned."""
AT_ONCE = 0.01
"""The same, if a request is too early in any case, and only the advice counts the messages before it."""
PAUSE = 0.15
"""Seconds after the first feedback message that the second run of a fast look is longer than the first."""
GOAL_LIMIT = 15.0
"""Seconds in which a goal must arrive once the client is on the graph."""
END_LIMIT = {Pace.FAST: 2.0, Pace.REAL_TIME: 5.0}
"""Seconds in which the client must ask for the result."""
HANGS_AFTER = {Pace.FAST: 2.0, Pace.REAL_TIME: 5.0}
"""Seconds after the result within which the client must have said how the goal ended; otherwise it hangs."""
AFTERMATH = 1.0
"""Seconds in which a client that has reported may end, or say more."""


def scenario(bench: Bench) -> None:
    """One run in which the cancel is honoured, one each in which it is refused or in vain, one in which the goal is."""
    first = run(bench, HONOURED, accept=True)
    request, tells = request_of(first), tells_of_cancel(first)
    if request is not None:
        cancel_is_refused(bench, first, request)
        if tells:
            run(bench, AGREED, first, accept=True)
    if goals(first) and not (bench.before and not refused_as_seen(bench.before) and bench.keep(REFUSED)):
        bench.part(REFUSED)
        prepared = needs_no_search(bench, first)
        refuse(bench, lambda: start(bench), known=True, prepared=prepared, may_stay=first.ending is None)


def tells_of_cancel(first: Part) -> bool:
    """Return True if a client says how its first goal ended. If not, it has lost the points for all ends."""
    return bool(OUTCOMES["canceled"].lines(first))


def start(bench: Bench) -> None:
    """Start the subject, which nothing keeps waiting."""
    bench.start()
    bench.release()


def cancel_is_refused(bench: Bench, first: Part, honoured: Request) -> None:
    """The run in which the goal succeeds in spite of the request to cancel it."""
    made = run(bench, CANCEL_REFUSED, first, accept=not honoured.asked_for_result, pause=PAUSE)
    refused = request_of(made)
    if bench.pace is Pace.FAST and refused is not None and not caused_by_feedback(honoured, refused):
        bench.doubt()


def caused_by_feedback(honoured: Request, refused: Request) -> bool:
    """True if a request is the answer to the same message in both runs, though the second one had a pause.

    A client that cancels by the clock may by chance ask just after a message; after a pause it asks at another one, or
    as early as without it.
    """
    return honoured.count == refused.count and refused.after - honoured.after >= PAUSE / 2


def run(bench: Bench, name: str, first: Part | None = None, *, accept: bool, pause: float = 0.0) -> Part:
    """Serve one goal; what was seen of that.

    Args:
        bench: The bench.
        name: Of the part.
        first: The first run of this look; None if this is it.
        accept: Whether a request to cancel is accepted.
        pause: Seconds to let pass after the first feedback message of a fast look.
    """
    before = bench.before
    if before is not None and needs_no_time(before, name, first) and bench.keep(name):
        return before.part(name)

    def serve(late: float = 0.0, held: float = 0.0) -> bool:
        serve_goal(bench, name, first, accept=accept, pause=pause, late=late, held=held)
        return True

    bench.part(name, gap=bench.random.uniform(*(SLOW if name == CANCEL_REFUSED else QUICK)))
    if first is None:
        waited = before is not None and bool(goals(before.part(name)))
        meets_late_action(bench, serve, ["goal", "cancel"], SOON if waited else LATENESS)
    else:
        meets_present(bench, serve, "goal", known=True)
    bench.stop()
    return bench.seen()


def needs_no_time(before: Evidence, name: str, first: Part | None) -> bool:
    """Return True if time cannot have played a part in a run of the fast look, so that it need not be made again.

    The client asked once, in answer to a message, and ended after its result. Its moment does not matter if the first
    run of this look has shown that this client asks at a wrong one.
    """
    part = before.part(name)
    result, ending = part.first("result"), part.ending
    if result is None or ending is None or ending.t < result.t or len(goals(part)) != 1:
        return False
    if len(part.of("cancel")) != 1:
        return False
    if first is not None and not in_the_window(first):
        return True
    return in_the_window(part) and was_asked_at_once(part, PROMPT) and asks_at_a_message(before)


def asks_at_a_message(before: Evidence) -> bool:
    """Return True if feedback caused the requests of the fast look."""
    honoured, refused = request_of(before.part(HONOURED)), request_of(before.part(CANCEL_REFUSED))
    return honoured is not None and refused is not None and caused_by_feedback(honoured, refused)


def serve_goal(
    bench: Bench, name: str, first: Part | None, *, accept: bool, pause: float, late: float, held: float
) -> None:
    """Start the subject and serve its goal to its end.

    Args:
        bench: The bench of the scenario.
        name: The name of the part.
        first: The first run of this look; None if this is it.
        accept: Whether a request to cancel is accepted.
        pause: Seconds to let pass after the first feedback message of a fast look.
        late: Seconds after its client at which the server comes.
        held: Seconds that the answers to goal and cancel are held back.
    """
    action, type_name = bench.reference.only("action_client")

    def served() -> ActionCounterpart:
        return bench.serve_action(
            action, type_name, accept_cancel=accept, goal_answer_takes=held, cancel_answer_takes=held
        )

    prepared = served() if first is not None and needs_no_search(bench, first) else None
    bench.start()
    there = bench.await_endpoint("action_client", action)
    bench.release()
    if there and late:
        bench.let_wait(late)
    # Not before the judge has met its client: the goal of one that ends at once would reach the judge or not.
    server = prepared or served()
    if not await_goal(bench, server, GOAL_LIMIT):
        return
    sequence = [0, 1]
    cancelled = send_feedback_until_cancelled(bench, server, sequence, pause)
    if cancelled:
        send_late_feedback(bench, server, sequence, name)
    never_asks = first is not None and first.first("result_request") is None
    in_vain = not cancelled or never_asks
    server.await_result_request(QUICK[0] if in_vain else END_LIMIT[bench.pace])
    if cancelled:
        hold_back(bench, "result_request")
    else:
        bench.note_whether_it_spins()
    server.finish(ENDS[name] if cancelled else "succeeded", sequence=sequence)
    lost = first is not None and not tells_of_cancel(first)
    if lost or bench.wait_until(lambda evidence: bool(after_result(evidence.main)), HANGS_AFTER[bench.pace]):
        bench.await_end(AFTERMATH)
    else:
        bench.note_where_it_hangs()


def send_feedback_until_cancelled(
    bench: Bench, server: ActionCounterpart, sequence: list[int], pause: float
) -> bool:
    """Send feedback until a cancel is requested, or until none is left. Return True if a cancel was requested."""
    gap = bench.seen().inputs["gap"]
    for count in range(WITHOUT_CANCEL + 1):
        if count == FIRST_STATUS:
            say_that_it_runs(bench, server)
        if count:
            send_next(server, sequence)
        if bench.pace is Pace.FAST:
            bench.settle()
            if count == 1:
                bench.run_time(pause)
            # Only at the edge of the window does it matter which message a request is counted after.
            early = count < FIRST_FEEDBACK - 1
            if server.await_cancel(AT_ONCE if early else PROMPT):
                return True
            if early:
                continue
        elif count > LAST_FEEDBACK:
            bench.settle()
            if server.await_cancel(AT_ONCE):
                return True
            continue
        quick = WINDOW_WAIT if FIRST_FEEDBACK <= count <= LAST_FEEDBACK else FEEDBACK_GAP
        usual = gap if count else FIRST_AFTER
        if server.await_cancel(quick if bench.pace is Pace.FAST else usual):
            # Nothing that was sent just now has caused it: perhaps a clock did, and it needs the real pace.
            bench.doubt()
            return True
    return bench.pace is Pace.REAL_TIME and server.await_cancel(CLOCKS)


def say_that_it_runs(bench: Bench, server: ActionCounterpart) -> None:
    """Say that the goal is executing, and let its client take that in before the next feedback comes."""
    server.say_status()
    if bench.pace is Pace.FAST:
        bench.settle()
    else:
        bench.run_time(LATE_GAP)


def send_late_feedback(bench: Bench, server: ActionCounterpart, sequence: list[int], name: str) -> None:
    """Let time pass in which nothing more may be asked for, then send feedback that must not be acted on."""
    action, _ = bench.reference.only("action_client")
    enough = WITH_LATE + 2 if name == HONOURED else len(sequence) + FEW_LATE
    if name in (HONOURED, CANCEL_REFUSED):
        # While its answer is held back, and later on: a client may ask again by the clock, or once it was refused.
        bench.wait_until(lambda seen: seen.main.first("cancel_answered") is not None, GOAL_LIMIT)
        bench.pass_time(LAB_TIME, "action_client", action)
        if bench.pace is Pace.FAST and len(bench.seen().of("cancel")) > 1:
            # A timer may have requested again, and would do so during late feedback at its real pace.
            bench.doubt()
    else:
        bench.run_time(FEEDBACK_GAP if bench.pace is Pace.FAST else QUICK[0])
    for left in reversed(range(enough - len(sequence))):
        send_next(server, sequence)
        if bench.pace is Pace.REAL_TIME:
            bench.run_time(LATE_GAP)
        # Also in real time: a client on a busy machine may not have come to what is due.
        if left % AT_A_TIME == 0:
            bench.settle()
    bench.run_time(FEEDBACK_GAP)


def send_next(server: ActionCounterpart, sequence: list[int]) -> None:
    """Append the next number and send what there is."""
    sequence.append(sequence[-1] + sequence[-2])
    server.send_feedback(partial_sequence=sequence)
