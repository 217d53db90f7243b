"""The time of the subject in one part: stepped where it follows the judge's clock, wall time elsewhere."""

from __future__ import annotations

import contextlib
import time
from typing import TYPE_CHECKING

from autograder.judge.bench import clock, graph
from autograder.judge.bench.clock import BorrowedTime, SimulatedClock
from autograder.judge.bench.presence import MATCH, Presence
from autograder.kit.giving_up import spared, willing
from autograder.kit.model import Pace

if TYPE_CHECKING:
    from collections.abc import Callable

    from autograder.judge.bench.recorder import Recorder
    from autograder.judge.bench.wire import Wire
    from autograder.judge.subjects.subject import Subject


class SubjectTime:
    """Lets time pass for the subject, and asks its nodes whether they have kept up.

    Args:
        wire: The judge's participant.
        recorder: What is seen, and what wakes up a wait.
        subject: Whose time it is.
        presence: The subject's nodes, and the judge's endpoints that they meet.
        opened: Closes at the end of the part what is made here.
        pace: Whether simulated time is tried at all.
        doubt: Called where something that is seen must be confirmed in real time.
    """

    def __init__(
        self,
        wire: Wire,
        recorder: Recorder,
        subject: Subject,
        presence: Presence,
        opened: contextlib.ExitStack,
        pace: Pace,
        doubt: Callable[[], None],
    ) -> None:
        self._wire = wire
        self._recorder = recorder
        self._subject = subject
        self._presence = presence
        self._open = opened
        self._pace = pace
        self._doubt = doubt
        self._clock: SimulatedClock | None = None
        self._clock_refused = False
        self._deaf: set[str] = set()

    def run(
        self, seconds: float, *, until: Callable[[], bool] | None = None, quiet: float | None = None
    ) -> bool:
        """Let ``seconds`` of the subject's time pass, or fewer where ``until`` holds or nothing happens.

        Returns:
            False where simulated time could not go on, because the subject's executor does not turn any more.
        """
        over = until or (lambda: False)
        if self._pace is Pace.FAST and self._follow_clock():
            assert self._clock is not None
            turns = self._clock.run(seconds, lambda: over() or self._subject.ended)
            if self._clock.doubtful:
                self._doubt()
            return turns
        self._recorder.wait(lambda: over() or self._subject.ended, seconds, quiet=quiet, wall=True)
        return True

    def lend(self, seconds: float, role: str, name: str) -> None:
        """Let simulated seconds pass for the node of an endpoint, which then has its own time back; else real ones."""
        for node in graph.owners(self._wire.node, role, name):
            if node.full not in self._deaf:
                with contextlib.closing(BorrowedTime(self._wire, self._recorder, node)) as borrowed:
                    if borrowed.let_pass(seconds, lambda: self._subject.ended):
                        return
        self._recorder.wait(lambda: self._subject.ended, seconds, wall=True)

    def let_wait(self, seconds: float, *, call: int = 0) -> None:
        """Let the subject wait for what the judge keeps from it; see :meth:`autograder.kit.model.Bench.let_wait`."""
        began = time.monotonic()

        def over() -> bool:
            seen = self._recorder.part()
            passed = time.monotonic() - began + (0.0 if call else spared(seen))
            return passed >= seconds or (call > 0 and willing(seen, call) >= seconds) or self._subject.ended

        self._recorder.wait(over, seconds, wall=True)

    def settle(self) -> None:
        """Ask each node of the subject's twice; a node that did not answer once is not asked again in this part."""
        limit = clock.ANSWER_LIMIT if self._pace is Pace.FAST else clock.PATIENT_ANSWER
        for node in self._presence.counterparts():
            if node.full in self._deaf or self._subject.ended:
                continue
            if not all(clock.answers(self._wire, self._recorder, node, limit) for _ in range(2)):
                self._deaf.add(node.full)

    def await_attention(self) -> None:
        """Ask each node that the judge is matched with, by a client that is announced after the judge's publishers.

        The announcements of one participant arrive in order (DDSI-RTPS, 8.5.4), so a node that answers the client knows
        the publishers, too.
        """
        for node in self._presence.counterparts():
            if not self._subject.ended:
                clock.answers(self._wire, self._recorder, node, MATCH)

    def _follow_clock(self) -> bool:
        """True if the subject follows a clock of the judge's; tried once, as soon as the judge has an endpoint."""
        tried = self._clock is not None or self._clock_refused
        if not tried and (self._presence.subscriptions or self._presence.publishers):
            self._clock_refused = True
            self._clock = self._clock_taken_over()
        return self._clock is not None

    def _clock_taken_over(self) -> SimulatedClock | None:
        """A clock that the subject follows; None where there is no node to step, or it keeps to its own time."""
        if any(self._wire.node.count_publishers(topic) > 1 for topic in self._presence.subscriptions):
            # Two nodes of one name share their parameter services: one of them would keep to real time.
            self._doubt()
            return None
        node = next(iter(self._presence.counterparts()), None)
        if node is None:
            return None
        stepped = SimulatedClock(self._wire, self._recorder, node)
        self._open.callback(stepped.close)
        if stepped.take_over() and stepped.stands_still(self._silence()):
            return stepped
        # It may yet obey later and then stop: only a fresh run in real time can tell.
        self._recorder.simulated_now = None
        if self._presence.subscriptions:
            self._doubt()
        return None

    def _silence(self) -> Callable[[], bool]:
        """A function that is true as long as nothing more is heard."""

        def heard() -> int:
            seen = self._recorder.part()
            return sum(len(seen.of("message", topic)) for topic in self._presence.subscriptions)

        before = heard()
        # One message may still have been on its way when the clock stopped.
        return lambda: heard() <= before + 1
