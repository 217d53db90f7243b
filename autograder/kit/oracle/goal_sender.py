"""The judge as an action's client in a scenario: it sends goals, alone or two at once, and cancels some of them."""

from __future__ import annotations

from statistics import median
from typing import TYPE_CHECKING, Any

from autograder.kit.bench import Bench, Pace
from autograder.kit.mistakes.hangs import ENDLESS
from autograder.kit.outcomes import SUCCEEDED, SentGoal, all_goals, goal

if TYPE_CHECKING:
    from collections.abc import Callable

    from autograder.kit.counterparts import ActionCaller

QUIET = {Pace.FAST: 3.0, Pace.REAL_TIME: 8.0}
"""The judge no longer waits if no event comes for this many seconds of wall time."""
GOAL_LIMIT = {Pace.FAST: 15.0, Pace.REAL_TIME: 30.0}
"""The judge no longer waits if nothing comes of a goal for this many seconds, even if the node says other things."""
TOO_MUCH = 30
"""A goal does not end if the server has sent so much feedback more than twice the most. No seconds limit a goal for
which feedback comes, so that a server may be slow, and the load of the machine changes nothing.
"""
CANCEL_LIMIT = {Pace.FAST: 4.0, Pace.REAL_TIME: 8.0}
"""The seconds in which a canceled goal must end. A server looks for a cancel request once in each round of its loop."""
UNREAD = 6
"""If this many feedback messages come without an answer to the cancel request, the server reads no request while it
works. Messages are counted, not seconds, so that the load of the machine changes nothing.
"""
AFTERMATH = 0.5
"""The seconds in which late feedback, or the end of a program that an exception has ended, must arrive."""
AT_WORK = 20.0
"""The maximum number of seconds of the subject's time that pass before a goal is sent beside one that is at work."""


_OF_A_GOAL = ("goal_answer", "feedback_heard", "cancel_answer", "goal_ended", "result_heard")


class GoalSender:
    """A client of the subject's action that waits for events, not for times.

    Args:
        bench: The bench of the scenario.
        caller: The judge's client.
        due: Returns how many feedback messages a goal must have sent when its result comes. A busy judge may receive
            them after the result, so it waits for them.
        most: The most feedback messages of a goal; by default as many as those of a server that tells everything again
            each time.
        simulated: True if the subject may follow simulated time, which then goes on while goals are at work.
    """

    def __init__(
        self,
        bench: Bench,
        caller: ActionCaller,
        due: Callable[[SentGoal], int] = lambda _: 0,
        *,
        most: float | None = None,
        simulated: bool = False,
    ) -> None:
        self.bench, self._caller, self._due, self._simulated = bench, caller, due, simulated
        self._most = most

    def __getitem__(self, number: int) -> SentGoal:
        """Return a goal as far as the judge has seen it."""
        return goal(self.bench.seen(), number)

    def send(self, number: int | None = None, /, **fields: Any) -> int:
        """Send a goal, and return its number. For the number see :meth:`ActionCaller.send_goal`."""
        return self._caller.send_goal(number, **fields)

    def finish(self, *numbers: int, quiet: float | None = None) -> bool:
        """Wait until goals have ended. Return False if one does not.

        Args:
            numbers: The goals.
            quiet: The judge gives up if no event comes for this many seconds of wall time.
        """
        ended = self._wait(lambda: all(self[number].over for number in numbers), quiet)
        if ended:
            self.bench.wait_until(lambda _: all(map(self._is_complete, numbers)), AFTERMATH)
        return ended

    def _is_complete(self, number: int) -> bool:
        return len(self[number].feedback) >= self._due(self[number])

    def await_feedback(self, number: int, messages: int) -> None:
        """Wait until a goal has sent so many feedback messages, or waiting is useless."""

        def has_told() -> bool:
            seen = self[number]
            return len(seen.feedback) >= messages or seen.over or (bool(seen.accepted) and self._is_silent())

        self._wait(has_told)

    def pass_time(self, number: int, messages: int) -> None:
        """Let the subject's time pass until a goal has sent so many feedback messages, or is over."""

        def has_told() -> bool:
            return len(self[number].feedback) >= messages or self[number].over

        self.bench.run_time(AT_WORK, until=has_told, quiet=QUIET[self.bench.pace])

    def _is_silent(self) -> bool:
        # A server that sends no feedback, or all of it at the end, may send none now: its goal would be over before.
        done = [one for one in all_goals(self.bench.seen()) if one.status == SUCCEEDED]
        return any(one.told_at_the_end or len(one.feedback) < min(1, self._due(one)) for one in done)

    def wait_half_a_round(self, number: int) -> None:
        """Wait for half the time between two feedback messages of a goal, so that two goals are served in turn."""
        pauses = self[number].pauses
        self.bench.wait_until(lambda _: False, median(pauses) / 2 if pauses else 0.0)

    def await_answer(self, number: int) -> bool:
        """Wait until the server has accepted or refused a goal. Return False if it does neither."""
        return self._wait(lambda: self[number].accepted is not None)

    def cancel(self, number: int, *, after: int = 0, then: Callable[[], object] | None = None) -> None:
        """Request to cancel a goal, unless it is over, and wait for its end.

        Args:
            number: The goal.
            after: The number of feedback messages after which the request is sent.
            then: Called as soon as the server has answered, perhaps before it has looked at the request.
        """
        self.await_feedback(number, after)
        if self[number].over:
            return
        self._caller.cancel(number)
        if then is not None:
            self._wait(lambda: self[number].cancel_accepted is not None)
            then()
        self.await_cancel(number)

    def await_cancel(self, number: int) -> None:
        """Wait until the server has refused to cancel a goal, or has ended it, or is seen to read no request."""

        def is_settled() -> bool:
            seen = self[number]
            unread = seen.cancel_accepted is None and seen.unread >= UNREAD
            return seen.cancel_is_over or unread

        limit = CANCEL_LIMIT[self.bench.pace]
        self.bench.wait_until(lambda _: is_settled(), limit, paced=self._simulated)
        if not self[number].cancel_is_over:
            # A MultiThreadedExecutor raises the exception of a callback only when it has something else to do.
            self.bench.settle()
            self.bench.await_end(AFTERMATH)

    def _wait(self, holds: Callable[[], bool], quiet: float | None = None) -> bool:
        """Wait until a condition holds. Return False if a goal has no end, or nothing comes of the goals any more."""
        pace, before = self.bench.pace, -1
        while not (holds() or self._note_endless()) and (came := self._came()) > before:
            before = came
            self.bench.wait_until(
                lambda _: holds() or self._came() > before,  # noqa: B023  (called at once)
                GOAL_LIMIT[pace],
                quiet=quiet or QUIET[pace],
                paced=self._simulated,
            )
        return holds()

    def _came(self) -> int:
        return sum(event.kind in _OF_A_GOAL for event in self.bench.seen().events)

    def _note_endless(self) -> bool:
        """Return True if a goal has sent too much feedback to end rightly, and note that."""
        sent = [
            len(one.feedback)
            for one in all_goals(self.bench.seen())
            if not one.over and len(one.feedback) > 2 * self._most_of(one) + TOO_MUCH
        ]
        if sent and not self.bench.seen().of("noted", ENDLESS):
            self.bench.note(ENDLESS, feedback=max(sent))
        return bool(sent)

    def _most_of(self, sent: SentGoal) -> float:
        due = max(0, self._due(sent))
        return due * (due + 3) / 2 if self._most is None else self._most
