"""Exercise 1.3: a client that cancels its goal after a few feedback messages and reports how the goal ended.

The judge is the action server. In a first part it cancels as it is asked to; in a second one it refuses and
the goal
succeeds, so that a client that only claims "canceled" is told from one that looked at the status.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from autograder.exercises import common_mistakes as common
from autograder.exercises.hangs import HANGS
from autograder.exercises.model import Advice, Bench, Criterion, Exercise, Finding, Look, Mistake

if TYPE_CHECKING:
    from collections.abc import Sequence

    from autograder.exercises.evidence import Event, Evidence, Part

HONOURED = "the server cancels"
REFUSED = "the server refuses to cancel"

FIRST_FEEDBACK, LAST_FEEDBACK = 3, 5
"""The cancel request must come after this many feedback messages, at the earliest and at the latest."""
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
        if bench.wait_until(lambda evidence: bool(_after_result(evidence.main)), HANGS_AFTER):
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


@dataclass(frozen=True)
class Request:
    """A request to cancel.

    Attributes:
        count: How many feedback messages were sent before it.
        after: Seconds of wall time from the goal to it.
    """

    count: int
    after: float


# --- questions to the evidence -----------------------------------------------------------------------------


def goals(part: Part) -> list[Event]:
    """The goals that were sent."""
    return part.of("goal")


def expected_order(evidence: Evidence) -> int:
    """The order that the reference solution asks for."""
    return int(goals(evidence.reference.part(HONOURED))[0].data["fields"]["order"])


def feedbacks_before_cancel(part: Part) -> int | None:
    """How many feedback messages were sent before the first cancel request; None where none came."""
    cancel = part.first("cancel")
    if cancel is None:
        return None
    before = part.events[: part.events.index(cancel)]
    return sum(event.kind == "feedback" for event in before)


def request_of(part: Part) -> Request | None:
    """The first request to cancel; None where none came."""
    goal, cancel, count = part.first("goal"), part.first("cancel"), feedbacks_before_cancel(part)
    if goal is None or cancel is None or count is None:
        return None
    return Request(count, cancel.t - goal.t)


def telling_count(evidence: Evidence) -> int | None:
    """How many feedback messages were sent before the cancel request, in the run where that is least right."""
    counts = [feedbacks_before_cancel(part) for part in evidence if goals(part)] or [None]
    return next((n for n in counts if n is None or not FIRST_FEEDBACK <= n <= LAST_FEEDBACK), counts[0])


def says_canceled(lines: Sequence[str], elsewhere: Sequence[str] = (), otherwise: Sequence[str] = ()) -> bool:
    """Whether a line names the status CANCELED, by its name or by its number 5 (action_msgs/msg/GoalStatus).

    Args:
        lines: What was said.
        elsewhere: What was said in the run with a goal that was not canceled: a 5 in the same place of a line there is
            no status.
        otherwise: What was said there of how the goal ended: a name that is in the same line there tells nothing.
    """
    ends = {_shape(line) for line in otherwise}
    return any(
        (_names_canceled(line) and _shape(line) not in ends) or _has_the_number(line, elsewhere)
        for line in lines
    )


def _has_the_number(line: str, elsewhere: Sequence[str]) -> bool:
    twins = [_numbers(other) for other in elsewhere if _shape(other) == _shape(line)]
    return any(
        number == "5" and all(twin[place] != "5" for twin in twins)
        for place, number in enumerate(_numbers(line))
    )


_NUMBER = re.compile(r"\d+(?:\.\d+)*")


def _numbers(line: str) -> list[str]:
    return _NUMBER.findall(_without_lists(line))


def _shape(line: str) -> str:
    """A line with a place for each number, so that two lines for two goals can be compared."""
    return _NUMBER.sub("#", _without_lists(line))


def _names_canceled(line: str) -> bool:
    return re.search(r"cancel|abgebrochen|annul", _without_lists(line), re.IGNORECASE) is not None


def _without_lists(line: str) -> str:
    # The numbers of a sequence are not a status.
    return re.sub(r"\[[^\]]*\]|\([\d, ]*\)", "", line)


def _after_result(part: Part) -> list[str]:
    result = part.first("result")
    return part.said(after=result) if result else []


def sends_the_goal(evidence: Evidence) -> Finding:
    """Exactly one goal of the reference's order."""
    wanted = expected_order(evidence)
    made = [int(goal.data["fields"]["order"]) for goal in goals(evidence.main)]
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
    said = _after_result(part)
    if not says_canceled(said, refused.said(), _after_result(refused)):
        return Finding(False, expected, f"“{said[-1]}”" if said else "nothing was said after the result")
    claimed = _false_claim(refused)
    if claimed:
        return Finding(False, expected, f"“{claimed}” about a goal that succeeded")
    return Finding(True, expected, f"“{said[-1]}”")


def _false_claim(refused: Part) -> str | None:
    """What it says that amounts to "the goal was canceled" although the goal succeeded."""
    if refused.first("result_request") is None:
        return None
    said = _after_result(refused)
    honest = r"succe|not |n't|4|refus|reject|fail|nicht|erfolg|unable|could|instead|denied|unknown"
    said = said or refused.said()
    claims = [line for line in said if _names_canceled(line)]
    if not claims or any(re.search(honest, _without_lists(line), re.IGNORECASE) for line in said):
        return None
    return claims[-1]


# --- known mistakes ----------------------------------------------------------------------------------------


def wrong_order(evidence: Evidence) -> Advice | None:
    """A goal of another order."""
    finding = sends_the_goal(evidence)
    if finding.passed or not goals(evidence.main):
        return None
    return Advice(
        f"The judge got {finding.seen}; the task asks for {finding.expected}.",
        f"Set goal.order = {expected_order(evidence)} and send the goal once.",
    )


def order_never_filled(evidence: Evidence) -> Advice | None:
    """A goal of order 0: the field's default."""
    made = goals(evidence.main)
    if not made or any(goal.data["fields"]["order"] != 0 for goal in made):
        return None
    return Advice(
        "The goal asks for order 0: its field was never filled.",
        "Set goal.order (or Fibonacci.Goal(order=...)). A misspelt keyword is ignored silently.",
    )


def never_spun(evidence: Evidence) -> Advice | None:
    """It sent its goal, and nothing that came back was taken in."""
    part = evidence.main
    if not goals(part) or part.first("cancel") is not None or not part.of("unanswered"):
        return None
    return Advice(
        "Your client sent its goal, but it takes in nothing that comes back: no callback of it is called "
        "any more.",
        "Spin it while it waits: rclpy.spin(node) or spin_until_future_complete(node, future), in one "
        "place, and never "
        "inside a callback.",
    )


def cancel_missing(evidence: Evidence) -> Advice | None:
    """A goal, feedback, and no cancel request."""
    part = evidence.main
    if not goals(part) or part.first("cancel") is not None:
        return None
    return Advice(
        "Your client sent its goal and got its feedback, but it never asked to cancel.",
        "Count in the feedback callback, and at the third message call goal_handle.cancel_goal_async(). "
        "Keep the "
        "goal_handle from the goal response.",
    )


def cancel_too_early(evidence: Evidence) -> Advice | None:
    """Fewer feedback messages than the task asks for."""
    count = telling_count(evidence)
    if count is None or count >= FIRST_FEEDBACK:
        return None
    return Advice(
        f"Your client asked to cancel after {count} feedback messages; the task asks for {FIRST_FEEDBACK} to "
        f"{LAST_FEEDBACK}.",
        f"Count the calls of the feedback callback and cancel when the count reaches {FIRST_FEEDBACK}.",
    )


def cancel_too_late(evidence: Evidence) -> Advice | None:
    """More feedback messages than the task asks for."""
    count = telling_count(evidence)
    if count is None or count <= LAST_FEEDBACK:
        return None
    return Advice(
        f"Your client asked to cancel only after {count} feedback messages; the task asks for "
        f"{FIRST_FEEDBACK} to "
        f"{LAST_FEEDBACK}.",
        f"Cancel in the feedback callback itself, when the count reaches {FIRST_FEEDBACK}: a timer of a "
        f"fixed length "
        "does not know how fast the server is.",
    )


def cancel_repeated(evidence: Evidence) -> Advice | None:
    """More than one cancel request."""
    total = len(evidence.main.of("cancel"))
    if total < 2:
        return None
    return Advice(
        f"Your client asked to cancel {total} times. Feedback goes on arriving until the server has ended "
        f"the goal.",
        "Remember that you have asked: test `count == 3` rather than `count >= 3`, or keep a flag.",
    )


def status_not_reported(evidence: Evidence) -> Advice | None:
    """It cancels, and never says how the goal ended."""
    part = evidence.part(HONOURED)
    if part.first("cancel") is None or says_canceled(_after_result(part), evidence.part(REFUSED).said()):
        return None
    if part.first("result_request") is None:
        return Advice(
            "Your client asked to cancel, but it never asked for the result, so it cannot know how the goal "
            "ended.",
            "Call goal_handle.get_result_async() once the goal is accepted, and read result.status when it "
            "is done.",
        )
    return Advice(
        "The goal ended with the status CANCELED (5), but your client did not say so after it got the "
        "result.",
        "When the result is there, log its status: future.result().status, by name or by number.",
    )


def status_misreported(evidence: Evidence) -> Advice | None:
    """It claims a cancel that did not happen."""
    claim = _false_claim(evidence.part(REFUSED))
    if claim is None:
        return None
    return Advice(
        f"The judge refused the cancel request and the goal succeeded, but your client said “{claim}”.",
        "Compare result.status with GoalStatus.STATUS_CANCELED before you say so: a cancel is a request, "
        "and the "
        "server may refuse it.",
    )


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
