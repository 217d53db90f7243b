"""Exercise 1.3: a client that cancels its goal after a few feedback messages and reports how the goal ended.

The judge is the action server. In a first part it comes late and cancels as it is asked to; in a second one the goal
succeeds all the same, so that a client that only claims "canceled" is told from one that looked at the status. There
the judge refuses to cancel. Of a client that never asked for the result it accepts the request, since only the status
on its topic tells then.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from exercise_1_3._cancel_evidence import (
    FIRST_FEEDBACK,
    HONOURED,
    LAST_FEEDBACK,
    LEFT,
    REFUSED,
    Request,
    after_result,
    expected_order,
    goals,
    left_before_its_answer,
    orders,
    request_of,
    telling_count,
)
from exercise_1_3._cancel_mistakes import (
    cancel_missing,
    cancel_repeated,
    cancel_too_early,
    cancel_too_late,
    ended_on_the_way,
    never_spun,
    not_waited_for,
    order_never_filled,
    result_repeated,
    status_misreported,
    status_not_reported,
    wrong_order,
)
from exercise_1_3._cancel_words import false_claim, says_canceled

from autograder.kit import common_mistakes as common
from autograder.kit.giving_up import LATENESS
from autograder.kit.goal_reports import MANY_REQUESTS, NOT_AWAITED, left_at_once
from autograder.kit.hangs import HANGS
from autograder.kit.lateness import (
    ANSWERS_SOON,
    SOON,
    TRIES,
    answers_late,
    hold_back,
    was_patient,
    was_patient_with_an_answer,
)
from autograder.kit.meant_errors import OTHER_SLIPS
from autograder.kit.model import ActionCounterpart, Bench, Criterion, Exercise, Finding, Look, Mistake

if TYPE_CHECKING:
    from autograder.kit.evidence import Event, Evidence, Part

WITHOUT_CANCEL = 19
"""Feedback messages that are sent to a client that does not cancel: all that a goal of order 20 has."""
WITH_LATE = 14
"""Feedback messages that are sent in all to one that does, to see that those after its request are not acted on."""
FEW_LATE = 3
"""Feedback messages after the request in the second run, which is about the end."""
AT_A_TIME = 3
"""Late feedback messages that are sent before the client has to have taken them; its queue holds ten."""
LAB_TIME = 1.5
"""Seconds of its own time in which a client must not ask once more; the lab's server takes less to end the goal."""

PACE = {Look.FAST: 0.03, Look.REAL_TIME: 0.5}
"""Seconds between two feedback messages outside the window in which a cancel is expected."""
LATE_PACE = 0.2
"""The same in real time after the request."""
WINDOW_PACE = {Look.FAST: 0.2, Look.REAL_TIME: 0.5}
"""Seconds that the server waits for a cancel after each feedback message inside that window."""
PROMPT = 0.05
"""Seconds of wall time in which a client that counts feedback has asked to cancel, once its executor has turned."""
AT_ONCE = 0.01
"""The same, where a request comes too early in any case, and only the advice counts the messages before it."""
PAUSE = 0.15
"""Seconds after the first feedback message that the second run of a fast look is longer than the first."""
GOAL_LIMIT = 15.0
"""Seconds in which a goal must arrive once the client is on the graph."""
END_LIMIT = {Look.FAST: 2.0, Look.REAL_TIME: 5.0}
"""Seconds in which the client must ask for the result."""
HANGS_AFTER = 5.0
"""Seconds after the result in which the client must have said how the goal ended; where it has not, it hangs."""
WAITS_FOR_ITSELF = ("nested_spin", "call_in_same_group")
"""Hangs that no time can end. In the others the client may be busy with something that comes to an end."""
AFTERMATH = 1.0
"""Seconds in which a client that has reported may end, or say more."""


def scenario(bench: Bench) -> None:
    """One run in which the cancel is honoured, one in which it is refused."""
    honoured = run(bench, HONOURED, accept=True)
    if honoured is None:
        return
    refused = run(bench, REFUSED, accept=not honoured.asked_for_result, pause=PAUSE)
    if bench.look is Look.FAST and refused is not None and not caused_by_feedback(honoured, refused):
        bench.doubt()


def caused_by_feedback(honoured: Request, refused: Request) -> bool:
    """Whether a request is the answer to the same message in both runs, though the second one had a pause.

    A client that cancels by the clock may by chance ask just after a message; after a pause it asks at another one, or
    as early as without it.
    """
    return honoured.count == refused.count and refused.after - honoured.after >= PAUSE / 2


def run(bench: Bench, name: str, *, accept: bool, pause: float = 0.0) -> Request | None:
    """Serve one goal; the first request to cancel it, or None.

    Args:
        bench: The bench.
        name: Of the part.
        accept: Whether a request to cancel is accepted.
        pause: Seconds to let pass after the first feedback message of a fast look.
    """
    bench.part(name)
    first = name == HONOURED
    late, held = (LATENESS, answers_late(bench)) if first else (0.0, 0.0)
    serve_goal(bench, name, accept=accept, pause=pause, late=late, held=held)
    if first and not goals(bench.seen()) and was_patient(bench.seen()):
        bench.again()
        late = SOON
        serve_goal(bench, name, accept=accept, pause=pause, late=late, held=held)
    for _ in range(TRIES if held else 0):
        seen = bench.seen()
        if seen.of("result_request") or not was_patient_with_an_answer(seen, ["goal", "cancel"]):
            break
        bench.again()
        serve_goal(bench, name, accept=accept, pause=pause, late=late, held=ANSWERS_SOON)
    request = request_of(bench.seen())
    bench.stop()
    return request


def serve_goal(bench: Bench, name: str, *, accept: bool, pause: float, late: float, held: float) -> None:
    """Start the subject and serve its goal to its end.

    Args:
        bench: Where it happens.
        name: Of the part.
        accept: Whether a request to cancel is accepted.
        pause: Seconds to let pass after the first feedback message of a fast look.
        late: Seconds after its client at which the server comes.
        held: Seconds that the answers to goal and cancel are held back.
    """
    action, type_name = bench.reference.only("action_client")
    bench.start(spare=late)
    there = bench.await_endpoint("action_client", action)
    bench.release()
    if there and late:
        bench.let_wait(late)
    # Not before the judge has met its client: the goal of one that ends at once would reach the judge or not.
    server = bench.serve_action(
        action, type_name, accept_cancel=accept, goal_answer_takes=held, cancel_answer_takes=held
    )
    if not server.await_goal(GOAL_LIMIT):
        return
    sequence = [0, 1]
    cancelled = send_feedback_until_cancelled(bench, server, sequence, pause)
    if cancelled:
        send_late_feedback(bench, server, sequence, watch=name == HONOURED)
    server.await_result_request(END_LIMIT[bench.look] if cancelled else PACE[Look.REAL_TIME])
    if cancelled:
        hold_back(bench, "result_request")
    else:
        bench.note_whether_it_spins()
    server.finish("canceled" if cancelled and name == HONOURED else "succeeded", sequence=sequence)
    if bench.wait_until(lambda evidence: bool(after_result(evidence.main)), HANGS_AFTER):
        bench.await_end(AFTERMATH)
    else:
        bench.note_where_it_hangs()


def send_feedback_until_cancelled(
    bench: Bench, server: ActionCounterpart, sequence: list[int], pause: float
) -> bool:
    """Send feedback until somebody asks to cancel, as much as there is; whether somebody did."""
    for count in range(WITHOUT_CANCEL + 1):
        if count:
            send_next(server, sequence)
        if bench.look is Look.FAST:
            bench.settle()
            if count == 1:
                bench.run_time(pause)
            # Only at the edge of the window does it matter which message a request is counted after.
            early = count < FIRST_FEEDBACK - 1
            if server.await_cancel(AT_ONCE if early else PROMPT):
                return True
            if early:
                continue
        inside = FIRST_FEEDBACK <= count <= LAST_FEEDBACK
        # The first feedback follows the acceptance at once, at any pace.
        pace = WINDOW_PACE[bench.look] if inside else PACE[bench.look if count else Look.FAST]
        if server.await_cancel(pace):
            # Nothing that was sent just now has caused it: perhaps a clock did, and it needs the real pace.
            bench.doubt()
            return True
    return False


def send_late_feedback(bench: Bench, server: ActionCounterpart, sequence: list[int], *, watch: bool) -> None:
    """Let time pass in which nothing more may be asked for, then send feedback that must not be acted on."""
    action, _ = bench.reference.only("action_client")
    enough = len(sequence) + FEW_LATE
    if watch:
        enough = WITH_LATE + 2
        # While its answer is held back, and later on.
        bench.wait_until(lambda seen: seen.main.first("cancel_answered") is not None, GOAL_LIMIT)
        bench.pass_time(LAB_TIME, "action_client", action)
    else:
        bench.run_time(PACE[bench.look])
    for left in reversed(range(enough - len(sequence))):
        send_next(server, sequence)
        if bench.look is Look.REAL_TIME:
            bench.run_time(LATE_PACE)
        # Also in real time: a client on a busy machine may not have come to what is due.
        if left % AT_A_TIME == 0:
            bench.settle()
    bench.run_time(PACE[Look.FAST])


def send_next(server: ActionCounterpart, sequence: list[int]) -> None:
    """Append the next number and send what there is."""
    sequence.append(sequence[-1] + sequence[-2])
    server.send_feedback(partial_sequence=sequence)


def sends_the_goal(evidence: Evidence) -> Finding:
    """Exactly one goal of the reference's order."""
    wanted = expected_order(evidence)
    made = orders(evidence)
    if made and left_at_once(evidence.main):
        return Finding(False, f"one goal of order {wanted}", NOT_AWAITED)
    seen = f"{len(made)} goals" if len(made) > 1 else f"order {made[0]}" if made else "no goal"
    return Finding(made == [wanted], f"one goal of order {wanted}", seen)


def cancels_in_the_window(evidence: Evidence) -> Finding:
    """The first cancel request comes after 3 to 5 feedback messages."""
    count = telling_count(evidence)
    expected = f"after {FIRST_FEEDBACK} to {LAST_FEEDBACK} feedback messages"
    seen = "no cancel request" if count is None else f"after {count} feedback messages"
    inside = count is not None and FIRST_FEEDBACK <= count <= LAST_FEEDBACK
    if count is not None and left_before_its_answer(evidence.main):
        return Finding(False, expected, LEFT)
    return Finding(inside and sends_the_goal(evidence).passed, expected, seen)


def cancels_once(evidence: Evidence) -> Finding:
    """No second cancel request before late feedback arrives."""
    cancels = _cancels(evidence.main)
    expected = "one cancel request, before more feedback arrives"
    if cancels and left_before_its_answer(evidence.main):
        return Finding(False, expected, LEFT)
    seen = f"{len(cancels)} cancel request{'s' * (len(cancels) != 1)}, before more feedback arrived"
    return Finding(len(cancels) == 1, expected, seen if cancels else "no cancel request")


def ignores_late_feedback(evidence: Evidence) -> Finding:
    """Feedback that arrives after the request causes no further request and no new goal."""
    part = evidence.main
    expected = "nothing more is asked for"
    first = part.first("cancel")
    if first is None:
        return Finding(False, expected, "no cancel request")
    if left_before_its_answer(part):
        return Finding(False, expected, LEFT)
    later = part.events[part.events.index(first) + 1 :]
    acted = [event for event in later if event.kind in ("cancel", "goal")]
    seen = f"{len(acted)} more {acted[0].kind} requests" if acted else expected
    return Finding(not acted, expected, seen)


def _cancels(part: Part) -> list[Event]:
    """The cancel requests, those that late feedback caused aside."""
    first = part.first("cancel")
    if first is None:
        return []
    found = [first]
    for event in part.events[part.events.index(first) + 1 :]:
        if event.kind == "feedback":
            break
        if event.kind == "cancel":
            found.append(event)
    return found


def reports_the_status(evidence: Evidence) -> Finding:
    """When the goal has ended it says "canceled" where it was, and not where it was not."""
    expected = "learns the status and says CANCELED (5), and only where it is so"
    part, refused = evidence.part(HONOURED), evidence.part(REFUSED)
    if part.first("cancel") is None:
        return Finding(False, expected, "no cancel request")
    asked = len(part.of("result_request"))
    if asked > MANY_REQUESTS:
        return Finding(False, expected, f"asked for the result {asked} times")
    said = after_result(part)
    if not says_canceled(said, refused.said(), after_result(refused)):
        if asked == 0:
            return Finding(False, expected, "never asked for the result")
        return Finding(False, expected, f"“{said[-1]}”" if said else "nothing was said after the result")
    claim = false_claim(part, refused)
    if claim:
        words, ended = claim
        return Finding(False, expected, f"“{words}” about a goal that {ended}")
    return Finding(True, expected, f"“{said[-1]}”")


EXERCISE = Exercise(
    id="exercise_1_3.cancel",
    title="Exercise 1.3 · Cancel a goal",
    task="Cancel a goal of order 20 after 3 to 5 feedback messages and report how it ended.",
    scenario=scenario,
    criteria=(
        Criterion("goal", "Sends one goal of the right order", 2, sends_the_goal),
        Criterion("cancel", "Asks to cancel at the right moment", 3, cancels_in_the_window),
        Criterion("once", "Asks only once at that moment", 1, cancels_once),
        Criterion("late_feedback", "Asks no more when more feedback arrives", 1, ignores_late_feedback),
        Criterion("status", "Reports how the goal really ended", 3, reports_the_status),
    ),
    mistakes=(
        *common.CRASHES,
        common.endpoint_name("action_client"),
        common.message_type("action_client"),
        *OTHER_SLIPS,
        Mistake("field_typo", order_never_filled, certain=True),
        Mistake("wrong_order", wrong_order, certain=True),
        Mistake("ended_too_early", ended_on_the_way),
        *(replace(hang, certain=hang.key in WAITS_FOR_ITSELF) for hang in HANGS),
        Mistake("gave_up_too_early", not_waited_for),
        Mistake("never_spun", never_spun),
        Mistake("cancel_missing", cancel_missing),
        Mistake("cancel_too_early", cancel_too_early),
        Mistake("cancel_too_late", cancel_too_late),
        Mistake("cancel_repeated", cancel_repeated, certain=True),
        Mistake("result_repeated", result_repeated, certain=True),
        Mistake("status_misreported", common.only_if_ended(status_misreported), certain=True),
        Mistake("status_not_reported", common.only_if_ended(status_not_reported), certain=True),
        Mistake("status_misreported", status_misreported),
        Mistake("status_not_reported", status_not_reported),
        *common.OTHER_CRASHES,
        *common.NOTHING_THERE,
    ),
    roles=("action_client",),
    limit=120.0,
)
