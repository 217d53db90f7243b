"""Exercise 1.3: a client that cancels its goal after a few feedback messages and reports how the goal ended.

The judge is the action server. In a first part it cancels as it is asked to; in a second one it refuses and the goal
succeeds, so that a client that only claims "canceled" is told from one that looked at the status.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from autograder.exercises import common_mistakes as common
from autograder.exercises.cancel_evidence import (
    FIRST_FEEDBACK,
    HONOURED,
    LAST_FEEDBACK,
    REFUSED,
    Request,
    after_result,
    expected_order,
    false_claim,
    orders,
    request_of,
    says_canceled,
    telling_count,
)
from autograder.exercises.cancel_mistakes import (
    cancel_missing,
    cancel_repeated,
    cancel_too_early,
    cancel_too_late,
    never_spun,
    order_never_filled,
    status_misreported,
    status_not_reported,
    wrong_order,
)
from autograder.exercises.hangs import HANGS
from autograder.exercises.model import Bench, Criterion, Exercise, Finding, Look, Mistake

if TYPE_CHECKING:
    from autograder.exercises.evidence import Event, Evidence, Part

WITHOUT_CANCEL = 9
"""Feedback messages that are sent to a client that does not cancel."""
LATE_FEEDBACK = 3
"""Feedback messages that are sent after the cancel request, to see that they are not acted on."""

PACE = {Look.FAST: 0.03, Look.REAL_TIME: 0.5}
"""Seconds between two feedback messages outside the window in which a cancel is expected."""
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
    refused = run(bench, REFUSED, accept=False, pause=PAUSE)
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
        accept: Whether the goal is cancelled when that is asked for.
        pause: Seconds to let pass after the first feedback message of a fast look.
    """
    action, type_name = bench.reference.only("action_client")
    bench.part(name)
    server = bench.serve_action(action, type_name, accept_cancel=accept)
    bench.start()
    bench.await_endpoint("action_client", action)
    bench.release()
    cancelled = False
    request = None
    if server.await_goal(GOAL_LIMIT):
        sequence = [0, 1]
        for count in range(WITHOUT_CANCEL + 1):
            if count:
                sequence.append(sequence[-1] + sequence[-2])
                server.send_feedback(partial_sequence=sequence)
            if bench.look is Look.FAST:
                bench.settle()
                if count == 1:
                    bench.run_time(pause)
                # Only at the edge of the window does it matter which message a request is counted after.
                early = count < FIRST_FEEDBACK - 1
                if server.await_cancel(AT_ONCE if early else PROMPT):
                    cancelled = True
                    break
                if early:
                    continue
            inside = FIRST_FEEDBACK <= count <= LAST_FEEDBACK
            # The first feedback follows the acceptance at once, at any pace.
            pace = WINDOW_PACE[bench.look] if inside else PACE[bench.look if count else Look.FAST]
            if server.await_cancel(pace):
                # Nothing that was sent just now has caused it: perhaps a clock did, and it needs the real pace.
                bench.doubt()
                cancelled = True
                break
        bench.run_time(PACE[bench.look])
        request = _request_now(bench)
        for _ in range(LATE_FEEDBACK if cancelled else 0):
            sequence.append(sequence[-1] + sequence[-2])
            server.send_feedback(partial_sequence=sequence)
            if bench.look is Look.REAL_TIME:
                bench.run_time(PACE[bench.look])
            # Also in real time: a client on a busy machine may not have come to what is due.
            bench.settle()
        if cancelled:
            bench.run_time(PACE[Look.FAST])
        server.await_result_request(END_LIMIT[bench.look] if cancelled else PACE[Look.REAL_TIME])
        if not cancelled:
            bench.note_whether_it_spins()
        server.finish("canceled" if cancelled and accept else "succeeded", sequence=sequence)
        if bench.wait_until(lambda evidence: bool(after_result(evidence.main)), HANGS_AFTER):
            bench.await_end(AFTERMATH)
        else:
            bench.note_where_it_hangs()
    bench.stop()
    return request


def _request_now(bench: Bench) -> Request | None:
    """The first request of this part as far as it has come."""
    found: list[Request | None] = []

    def look_at(evidence: Evidence) -> bool:
        found.append(request_of(evidence.main))
        return True

    bench.wait_until(look_at, 0.0)
    return found[-1]


def sends_the_goal(evidence: Evidence) -> Finding:
    """Exactly one goal of the reference's order."""
    wanted = expected_order(evidence)
    made = orders(evidence)
    seen = f"{len(made)} goals" if len(made) > 1 else f"order {made[0]}" if made else "no goal"
    return Finding(made == [wanted], f"one goal of order {wanted}", seen)


def cancels_in_the_window(evidence: Evidence) -> Finding:
    """The first cancel request comes after 3 to 5 feedback messages."""
    count = telling_count(evidence)
    expected = f"after {FIRST_FEEDBACK} to {LAST_FEEDBACK} feedback messages"
    seen = "no cancel request" if count is None else f"after {count} feedback messages"
    inside = count is not None and FIRST_FEEDBACK <= count <= LAST_FEEDBACK
    return Finding(inside and sends_the_goal(evidence).passed, expected, seen)


def cancels_once(evidence: Evidence) -> Finding:
    """No second cancel request before late feedback arrives."""
    cancels = _cancels(evidence.main)
    return Finding(
        len(cancels) == 1, "one cancel request", f"{len(cancels)} cancel request{'s' * (len(cancels) != 1)}"
    )


def ignores_late_feedback(evidence: Evidence) -> Finding:
    """Feedback that arrives after the request causes no further request and no new goal."""
    part = evidence.main
    expected = "nothing more is asked for"
    first = part.first("cancel")
    if first is None:
        return Finding(False, expected, "no cancel request")
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
    """After the result it says "canceled" where the goal was, and not where it was not."""
    expected = "asks for the result and says CANCELED (5), and only where it is so"
    part, refused = evidence.part(HONOURED), evidence.part(REFUSED)
    if part.first("cancel") is None:
        return Finding(False, expected, "no cancel request")
    if part.first("result_request") is None:
        return Finding(False, expected, "never asked for the result")
    said = after_result(part)
    if not says_canceled(said, refused.said(), after_result(refused)):
        return Finding(False, expected, f"“{said[-1]}”" if said else "nothing was said after the result")
    claimed = false_claim(refused)
    if claimed:
        return Finding(False, expected, f"“{claimed}” about a goal that succeeded")
    return Finding(True, expected, f"“{said[-1]}”")


EXERCISE = Exercise(
    id="exercise_1_3.cancel",
    title="Exercise 1.3 · Cancel a goal",
    task="Cancel a goal of order 20 after 3 to 5 feedback messages and report how it ended.",
    scenario=scenario,
    criteria=(
        Criterion("goal", "Sends one goal of the right order", 2, sends_the_goal),
        Criterion("cancel", "Asks to cancel at the right moment", 3, cancels_in_the_window),
        Criterion("once", "Asks to cancel once", 1, cancels_once),
        Criterion("late_feedback", "Does not act on feedback after that", 1, ignores_late_feedback),
        Criterion("status", "Reports how the goal really ended", 3, reports_the_status),
    ),
    mistakes=(
        *common.CRASHES,
        common.endpoint_name("action_client"),
        common.message_type("action_client"),
        *common.OTHER_CRASHES,
        Mistake("field_typo", order_never_filled, certain=True),
        Mistake("wrong_order", wrong_order, certain=True),
        *(replace(hang, certain=hang.key in WAITS_FOR_ITSELF) for hang in HANGS),
        Mistake("never_spun", never_spun),
        Mistake("cancel_missing", cancel_missing),
        Mistake("cancel_too_early", cancel_too_early),
        Mistake("cancel_too_late", cancel_too_late),
        Mistake("cancel_repeated", cancel_repeated, certain=True),
        Mistake("status_misreported", common.only_if_ended(status_misreported), certain=True),
        Mistake("status_not_reported", common.only_if_ended(status_not_reported), certain=True),
        Mistake("status_misreported", status_misreported),
        Mistake("status_not_reported", status_not_reported),
        *common.NOTHING_THERE,
    ),
    roles=("action_client",),
    limit=120.0,
)
