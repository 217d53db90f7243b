"""A recipe for a client that cancels its goal: the judge is the server, cancels the goal or not, and keeps its pace.

In a first run the server comes late and cancels as it is asked to. In a second one the goal succeeds all the same, so
that a client that only claims "canceled" is told from one that looked at the status: the judge refuses to cancel, or
accepts the request of a client that never asks for the result, since only the status on its topic tells then. In a
third run the judge agrees to cancel, and the goal is aborted: that the server agreed does not say how the goal ended.
In a fourth one the goal itself is refused.

The judge waits for nothing that cannot change the verdict any more. The look in real time repeats only those runs in
which time may have played a part, and its server comes sooner if the client has already waited for a late one. Once the
moment for the request is over, the remaining feedback comes quickly. A client that does not say how its first goal
ended has lost the points for the ends of all goals.

In real time, the feedback of the first run comes several times as fast as that of the second: no clock, only a count,
says in both when the message has come after which the client has to ask.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import TYPE_CHECKING, Any

from autograder.kit.bench import Bench, Pace
from autograder.kit.goal_reports import REFUSED, refused_as_seen
from autograder.kit.lateness import (
    SOON,
    await_goal,
    hold_back,
    late_at_first,
    meets_late_action,
    meets_present,
)
from autograder.kit.oracle.cancel_requests import (
    AGREED,
    CANCEL_REFUSED,
    HONORED,
    OUTCOMES,
    after_result,
    cancel_request,
)
from autograder.kit.recipes.action_client import ActionClient
from autograder.kit.recipes.one_goal import (
    AFTERMATH,
    END_LIMIT,
    GOAL_LIMIT,
    meets_server,
    needs_no_search,
    refuse,
)

if TYPE_CHECKING:
    from autograder.kit.counterparts import ActionCounterpart
    from autograder.kit.evidence import Evidence, Part
    from autograder.kit.model import Mistake

Fields = Callable[[int], Mapping[str, Any]]
"""A function of the number of feedback messages that have been sent, this one included; it returns the fields."""
CLOCKS = 2.5
"""Seconds after the last feedback in which a client that goes by a clock may still ask, far too late: the card then
says so."""
AT_A_TIME = 3
"""Late feedback messages that are sent before the client has to have taken them; its queue holds ten."""
ASKS_AGAIN = 1.5
"""Seconds of its own time in which a client must not ask once more; the lab's server takes less to end the goal."""
FIRST_STATUS = 2
"""The goal's status is published before this feedback message: some time after its acceptance, before any cancel is
due.
"""
FEEDBACK_GAP = 0.03
"""Seconds between two feedback messages in a fast look, outside the window in which a cancel is expected."""
WINDOW_WAIT = 0.2
"""Seconds that a fast look waits for a cancel after each feedback message inside that window."""
QUICK, SLOW = (0.47, 0.52), (2.35, 2.45)
"""Two ranges of the same seconds in real time. The lab's server is as quick as the first.

The window of a quick run, from the third message to the sixth, ends before that of the slow run begins, even counted
from the client's start. So a request that comes a fixed time after anything is outside of one of the two windows.
"""
FIRST_AFTER = 0.25
"""Seconds from the answer to the goal to its first feedback message in real time."""
LATE_GAP = 0.2
"""Seconds between two feedback messages in real time after the request."""
PROMPT = 0.05
"""Seconds of wall time in which a client that counts feedback has asked to cancel, once its executor has turned."""
AT_ONCE = 0.01
"""The same, if a request is too early in any case, and only the advice counts the messages before it."""
PAUSE = 0.15
"""Seconds after the first feedback message that the second run of a fast look is longer than the first."""
LATE = 11
"""Feedback messages after the request, to see that they are not acted on."""
ENDS = {HONORED: "canceled", CANCEL_REFUSED: "succeeded", AGREED: "aborted"}
"""The end of a goal after a request to cancel it, by the name of the run; any other goal succeeds."""


class CancelsGoal(ActionClient):
    """The recipe for a client that asks to cancel its goal after some feedback messages.

    Args:
        window: After how many feedback messages the client must ask, at the earliest and at the latest.
        feedback: Returns the fields of a feedback message.
        result: Returns the fields of the result.
        ladder: The mistakes of the exercise, most specific first.
        most: The number of feedback messages that are sent to a client that does not ask.

    Example::

        recipe = CancelsGoal(
            (3, 5),
            lambda count: {"partial_sequence": list(range(count))},
            lambda count: {"sequence": list(range(count))},
        )
    """

    def __init__(
        self, window: tuple[int, int], feedback: Fields, result: Fields, *ladder: Mistake, most: int = 19
    ) -> None:
        super().__init__(self._scenario, *ladder)
        self._window, self._feedback, self._result, self._most = window, feedback, result, most

    def _in_window(self, part: Part) -> bool:
        """Return True if the first request of a run came after as many feedback messages as the task asks for."""
        request = cancel_request(part)
        return request is not None and self._window[0] <= request.count <= self._window[1]

    def _scenario(self, bench: Bench) -> None:
        """Make one run in which the cancel is honored, one each in which it is refused or in vain, one without goal."""
        first = self._run(bench, HONORED)
        if cancel_request(first):
            second = self._run(bench, CANCEL_REFUSED, first)
            if bench.pace is Pace.FAST and cancel_request(second) and not caused_by_feedback(first, second):
                bench.doubt()
            if tells_of_cancel(first):
                self._run(bench, AGREED, first)
        before = bench.before
        if not first.of("goal") or first.of("unanswered"):
            return  # a client that no longer answers at all has lost the next run, too
        if before and not refused_as_seen(before) and bench.keep(REFUSED):
            return
        bench.part(REFUSED)
        prepared = needs_no_search(bench, first)
        begin_it = partial(_start, bench)
        refuse(bench, begin_it, known=True, prepared=prepared, may_stay=first.ending is None)

    def _run(self, bench: Bench, name: str, first: Part | None = None) -> Part:
        """Serve one goal, and return the record of the run. ``first`` is the first run of this look, if it was made."""
        before = bench.before
        if before and self._needs_no_time(before, name, first) and bench.keep(name):
            return before.part(name)

        def meet(late: float = 0.0, held: float = 0.0) -> bool:
            self._serve(bench, name, first, late=late, held=held)
            return True

        bench.part(name, gap=bench.random.uniform(*(SLOW if name == CANCEL_REFUSED else QUICK)))
        if first is None:
            waited = before is not None and bool(before.part(name).of("goal"))
            meets_late_action(bench, meet, ["goal", "cancel"], SOON if waited else late_at_first(bench))
        else:
            meets_present(bench, meet, "goal", known=True)
        bench.stop()
        return bench.seen()

    def _needs_no_time(self, before: Evidence, name: str, first: Part | None) -> bool:
        """Return True if time cannot have played a part in a run of the fast look, so that it need not be made again.

        The client asked once, in answer to a message, and ended after its result. Its moment does not matter if the
        first run of this look has shown that this client asks at a wrong one.
        """
        part = before.part(name)
        result, ending, request = part.first("result"), part.ending, cancel_request(part)
        if not (result and ending and request) or ending.t < result.t:
            return False
        if len(part.of("goal")) != 1 or len(part.of("cancel")) != 1:
            return False
        if first and not self._in_window(first):
            return True
        prompt = self._in_window(part) and request.since_feedback <= PROMPT
        return prompt and caused_by_feedback(before.part(HONORED), before.part(CANCEL_REFUSED))

    def _serve(self, bench: Bench, name: str, first: Part | None, *, late: float, held: float) -> None:
        """Start the subject and serve its goal to its end.

        Args:
            late: Seconds after its client at which the server comes.
            held: Seconds that the answers to goal and cancel are held back.
        """
        never_asks = first is not None and first.first("result_request") is None
        server = meets_server(
            bench,
            partial(_start, bench),
            prepared=first is not None and needs_no_search(bench, first),
            late=late,
            accept_cancel=never_asks or name != CANCEL_REFUSED,
            goal_answer_takes=held,
            cancel_answer_takes=held,
        )
        if not await_goal(bench, server, GOAL_LIMIT):
            return
        count, canceled = self._until_canceled(bench, server, PAUSE if name == CANCEL_REFUSED else 0.0)
        if canceled:
            count = self._send_late_feedback(bench, server, count)
        server.await_result_request(QUICK[0] if never_asks or not canceled else END_LIMIT[bench.pace])
        if canceled:
            hold_back(bench, "result_request")
        else:
            bench.note_whether_it_spins()
        server.finish(ENDS[name] if canceled else "succeeded", **self._result(count))
        lost = first is not None and not tells_of_cancel(first)
        if lost or bench.wait_until(lambda seen: bool(after_result(seen.main)), END_LIMIT[bench.pace]):
            bench.await_end(AFTERMATH)
        else:
            bench.note_where_it_hangs()

    def _until_canceled(self, bench: Bench, server: ActionCounterpart, pause: float) -> tuple[int, bool]:
        """Send feedback until a cancel is requested, or none is left. Return the number of messages, and if it was.

        In a fast look, a client that counts messages asks at once; one that asks a moment later may go by a clock.
        """
        is_fast = bench.pace is Pace.FAST
        for count in range(self._most + 1):
            if count == FIRST_STATUS:
                server.say_status()
                if is_fast:
                    bench.settle()
                else:
                    bench.run_time(LATE_GAP)
            if count:
                server.send_feedback(**self._feedback(count))
            if is_fast or count > self._window[1]:
                bench.settle()
            if is_fast and count == 1:
                bench.run_time(pause)
            for by_a_clock, wait in enumerate(self._waits(bench, count)):
                if server.await_cancel(wait):
                    if by_a_clock:
                        bench.doubt()
                    return count, True
        return count, not is_fast and server.await_cancel(CLOCKS)

    def _waits(self, bench: Bench, count: int) -> tuple[float, ...]:
        """Return the seconds to wait for a request after a message; then those in which only a clock can cause it."""
        first, last = self._window
        if bench.pace is Pace.REAL_TIME:
            usual = bench.seen().inputs["gap"] if count else FIRST_AFTER
            return (AT_ONCE if count > last else usual,)
        # Only at the edge of the window does it matter which message a request is counted after.
        if count < first - 1:
            return (AT_ONCE,)
        return PROMPT, WINDOW_WAIT if first <= count <= last else FEEDBACK_GAP

    def _send_late_feedback(self, bench: Bench, server: ActionCounterpart, count: int) -> int:
        """Let time pass in which nothing more may be asked for, then send feedback that must not be acted on.

        Return the number of feedback messages in all.
        """
        action, _ = bench.reference.only("action_client")
        # While its answer is held back, and later on: a client may ask again by the clock, or once it was refused.
        bench.wait_until(lambda seen: seen.main.first("cancel_answered") is not None, GOAL_LIMIT)
        bench.pass_time(ASKS_AGAIN, "action_client", action)
        if bench.pace is Pace.FAST and len(bench.seen().of("cancel")) > 1:
            # A timer may have requested again, and would do so during late feedback at its real pace.
            bench.doubt()
        for late in range(1, LATE + 1):
            server.send_feedback(**self._feedback(count + late))
            if bench.pace is Pace.REAL_TIME:
                bench.run_time(LATE_GAP)
            # Also in real time: a client on a busy machine may not have come to what is due.
            if late % AT_A_TIME == 0:
                bench.settle()
        bench.settle()
        return count + LATE


def _start(bench: Bench) -> None:
    bench.start()
    bench.release()


def tells_of_cancel(first: Part) -> bool:
    """Return True if a client says how its first goal ended. If not, it has lost the points for all ends."""
    return bool(OUTCOMES["canceled"].lines(first))


def caused_by_feedback(first: Part, second: Part) -> bool:
    """Return True if the requests of the first two runs answer the same message, though the second run had a pause.

    A client that cancels by the clock may by chance ask just after a message; after a pause it asks at another one, or
    as early as without it.
    """
    one, two = cancel_request(first), cancel_request(second)
    if one is None or two is None:
        return False
    return one.count == two.count and two.since_goal - one.since_goal >= PAUSE / 2
