"""The time of the subject in one part: stepped where it follows the judge's clock, wall time elsewhere.

In simulated time the judge publishes ``/clock`` and steps it, so that seconds cost milliseconds. Each step is followed
by questions to the subject's parameter service. The answers prove that its executor has called the timers of the step,
so the result does not depend on how busy the machine is. What does not follow the clock (a ``time.sleep``, a loop that
spins only now and then) shows itself: it publishes while the clock stands still, or its executor is slow to answer; the
caller then looks again in real time.
"""

from __future__ import annotations

import contextlib
import threading
import time
from typing import TYPE_CHECKING, Any

from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import GetParameters, SetParameters
from rclpy.qos import QoSProfile
from rosgraph_msgs.msg import Clock

from autograder.judge.bench import graph
from autograder.judge.bench.patience import Patience
from autograder.judge.bench.presence import MATCH, Presence
from autograder.kit.model import STEP, Pace

if TYPE_CHECKING:
    from collections.abc import Callable

    from autograder.judge.bench.graph import NodeName
    from autograder.judge.bench.recorder import Recorder
    from autograder.judge.bench.wire import Wire
    from autograder.judge.subjects.subject import Subject

ANSWER_LIMIT = 0.5
"""Seconds of wall time in which a spinning node answers a question; one that does not is not stepped."""
PATIENT_ANSWER = 1.5
"""Seconds of wall time after which a node that does not answer is taken not to be spun."""
TURNS = 3
"""Turns of an executor after which it has called the timers that a new time makes due.

It takes the time in one and calls the timers in the next. And where it looks at its subscriptions a moment before the
time arrives, and at its services a moment after the question has, the first turn is about the question alone.
"""
FIRST = 100.0
"""Simulated seconds at the start. The jump to it distorts the first interval, which nobody counts."""
SLOW_STEP = 0.25
"""Seconds of wall time after which a step is suspicious: the subject sleeps, or the machine is overloaded."""
STANDSTILL = 0.06
"""Seconds of wall time for which the clock stands still before it is stepped."""
LENT_STEP = 0.1
"""Simulated seconds a step of lent time. What a timer does more often is done in real time before anybody looks."""
_SIM_TIME = "use_sim_time"
_QUESTION = GetParameters.Request(names=[_SIM_TIME])


class NodeClock:
    """Publishes ``/clock`` for one node of the subject's, and asks whether it keeps up.

    The answer of its parameter service proves that its executor has turned since the question. An executor takes one
    request of a service in each of its turns (rclpy/executors.py, ``_take_service``), so questions that are asked
    together are answered in as many turns, and cost one journey to the node and back.
    """

    def __init__(self, wire: Wire, recorder: Recorder, node: NodeName) -> None:
        self._wire = wire
        self._recorder = recorder
        self._publisher = wire.node.create_publisher(Clock, "/clock", QoSProfile(depth=10))
        self._set = wire.node.create_client(SetParameters, f"{node.full}/set_parameters")
        self._get = wire.node.create_client(GetParameters, f"{node.full}/get_parameters")

    def follow(self, simulated: bool) -> bool:
        """Have the node follow simulated time, or its own again; whether it said yes."""
        value = ParameterValue(type=ParameterType.PARAMETER_BOOL, bool_value=simulated)
        request = SetParameters.Request(parameters=[Parameter(name=_SIM_TIME, value=value)])
        answer = ask(self._recorder, self._set, request, ANSWER_LIMIT)
        return answer is not None and bool(answer.results) and bool(answer.results[0].successful)

    def is_heard(self) -> bool:
        """Wait until somebody hears the clock."""
        return self._recorder.wait(
            lambda: self._publisher.get_subscription_count() > 0, ANSWER_LIMIT, poll=0.002
        )

    def is_rivalled(self) -> bool:
        """True if somebody else publishes on /clock, too."""
        return self._wire.node.count_publishers("/clock") > 1

    def show(self, now: float) -> bool:
        """Publish the time, in seconds; whether the node's executor has called the timers that are due by it."""
        message = Clock()
        message.clock.sec = int(now)
        message.clock.nanosec = round((now - int(now)) * 1e9)
        self._publisher.publish(message)
        return ask(self._recorder, self._get, _QUESTION, ANSWER_LIMIT, turns=TURNS) is not None

    def lend(self, seconds: float, until: Callable[[], bool]) -> bool:
        """Let seconds pass for a node that lives in real time: its timers fire as they would later on.

        What a program does by its timers in the next seconds is seen in milliseconds. Its clock goes on from where it
        is, and is given back afterwards, so nothing that it has begun is lost. What does not follow a clock (a thread
        that sleeps) is not seen so.

        Args:
            seconds: At most so many.
            until: Stop when this holds.

        Returns:
            Whether the node went along: it took the clock, and answered after each step.
        """
        began = time.time()
        try:
            if not (self.follow(True) and self.is_heard() and self.show(began)):
                return False
            steps = range(1, round(seconds / LENT_STEP) + 1)
            return all(until() or self.show(began + LENT_STEP * step) for step in steps)
        finally:
            self.follow(False)

    def close(self) -> None:
        """Stop publishing and asking."""
        self._wire.node.destroy_publisher(self._publisher)
        self._wire.node.destroy_client(self._set)
        self._wire.node.destroy_client(self._get)


def ask(recorder: Recorder, client: Any, request: Any, limit: float, *, turns: int = 1) -> Any:
    """The answer of a service of the subject's, or None where its executor does not turn in time.

    Args:
        recorder: What wakes up a wait.
        client: Of the service.
        request: What is asked.
        limit: Seconds of wall time for each turn.
        turns: Turns that the executor must make: the request is sent so often at once, and the last answer counts.
    """
    if not recorder.wait(client.service_is_ready, limit, poll=0.005):
        return None
    futures = [client.call_async(request) for _ in range(turns)]
    return futures[-1].result() if all(_is_there(future, limit) for future in futures) else None


def _is_there(future: Any, limit: float) -> bool:
    if future.done():
        return True
    done = threading.Event()
    future.add_done_callback(lambda _: done.set())
    patience = Patience(limit)
    while not done.is_set() and (left := patience.left) > 0:
        done.wait(left)
    return done.is_set()


def answers(wire: Wire, recorder: Recorder, node: NodeName, limit: float = PATIENT_ANSWER) -> bool:
    """True if a node answers, within ``limit`` seconds, a question that every spun node answers."""
    client = wire.node.create_client(GetParameters, f"{node.full}/get_parameters")
    try:
        return ask(recorder, client, _QUESTION, limit) is not None
    finally:
        wire.node.destroy_client(client)


class SimulatedClock(NodeClock):
    """Steps the clock of one node.

    Attributes:
        doubtful: A step took so long, or somebody else moved the clock too, that what was seen must be confirmed in
            real time.
    """

    def __init__(self, wire: Wire, recorder: Recorder, node: NodeName) -> None:
        super().__init__(wire, recorder, node)
        self.doubtful = False
        self._now = FIRST

    def take_over(self) -> bool:
        """Make the node follow simulated time.

        Returns:
            Whether it said yes, hears the clock and its executor answers. A True does not yet prove that its
            timers follow: :meth:`stands_still` does.
        """
        if not (self.follow(True) and self.is_heard()):
            return False
        self._recorder.simulated_now = self._now
        return self.show(self._now)

    def stands_still(self, silent: Callable[[], bool]) -> bool:
        """Hold the clock for a moment; whether the subject stays silent as long.

        Args:
            silent: Tells whether nothing was heard since it was made.
        """
        self._recorder.wait(lambda: not silent(), STANDSTILL)
        return silent()

    def run(self, seconds: float, until: Callable[[], bool], step: float = STEP) -> bool:
        """Go through ``seconds`` of simulated time in steps of ``step`` seconds, or until something holds.

        Returns:
            Whether the subject's executor answered after each step.
        """
        # Rounded as each step is: a sum of floats may lie a little above the last one.
        end = round(self._now + seconds, 6)
        while self._now < end and not until():
            began = time.monotonic()
            self._now = round(min(self._now + step, end), 6)
            self._recorder.simulated_now = self._now
            if not self.show(self._now):
                self.doubtful = True
                return False
            # Where somebody else moves the clock, simulated time says nothing about the subject's rate.
            slow = time.monotonic() - began > SLOW_STEP
            self.doubtful = self.doubtful or slow or self.is_rivalled()
        return True

    def close(self) -> None:
        """Stop publishing and asking."""
        self._recorder.simulated_now = None
        super().close()


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
        self,
        seconds: float,
        *,
        until: Callable[[], bool] | None = None,
        quiet: float | None = None,
        step: float = STEP,
    ) -> bool:
        """Let ``seconds`` of the subject's time pass, or fewer where ``until`` holds or nothing happens.

        Returns:
            False where simulated time could not go on, because the subject's executor does not turn any more.
        """
        over = until or (lambda: False)
        if self._pace is Pace.FAST and self._follow_clock():
            assert self._clock is not None
            turns = self._clock.run(seconds, lambda: over() or self._subject.ended, step)
            if self._clock.doubtful:
                self._doubt()
            return turns
        self._recorder.wait(lambda: over() or self._subject.ended, seconds, quiet=quiet, wall=True)
        return True

    def lend(self, seconds: float, role: str, name: str) -> None:
        """Let simulated seconds pass for the node of an endpoint, which then has its own time back; else real ones."""
        for node in graph.owners(self._wire.node, role, name):
            if node.full not in self._deaf:
                with contextlib.closing(NodeClock(self._wire, self._recorder, node)) as clock:
                    if clock.lend(seconds, lambda: self._subject.ended):
                        return
        self._recorder.wait(lambda: self._subject.ended, seconds, wall=True)

    def settle(self) -> None:
        """Ask each node of the subject's twice; a node that did not answer once is not asked again in this part."""
        limit = ANSWER_LIMIT if self._pace is Pace.FAST else PATIENT_ANSWER
        for node in self._presence.counterparts():
            if node.full in self._deaf or self._subject.ended:
                continue
            if not all(answers(self._wire, self._recorder, node, limit) for _ in range(2)):
                self._deaf.add(node.full)

    def await_attention(self) -> None:
        """Ask each node that the judge is matched with, by a client that is announced after the judge's publishers.

        The announcements of one participant arrive in order (DDSI-RTPS, 8.5.4), so a node that answers the client knows
        the publishers, too.
        """
        for node in self._presence.counterparts():
            if not self._subject.ended:
                answers(self._wire, self._recorder, node, MATCH)

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
