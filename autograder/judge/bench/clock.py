"""Simulated time: the judge publishes ``/clock`` and steps it, so that seconds cost milliseconds.

Each step is followed by questions to the subject's parameter service. The answers prove that its executor has called
the timers of the step, so the result does not depend on how busy the machine is. What does not follow the clock (a
``time.sleep``, a loop that spins only now and then) shows itself: it publishes while the clock stands still, or its
executor is slow to answer; the caller then looks again in real time.
"""

from __future__ import annotations

import threading
import time
from typing import TYPE_CHECKING, Any

from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import GetParameters, SetParameters
from rclpy.qos import QoSProfile
from rosgraph_msgs.msg import Clock

from autograder.judge.bench.patience import Patience

if TYPE_CHECKING:
    from collections.abc import Callable

    from autograder.judge.bench.graph import NodeName
    from autograder.judge.bench.recorder import Recorder
    from autograder.judge.bench.wire import Wire


ANSWER_LIMIT = 0.5
"""Seconds of wall time in which a spinning node answers a question; one that does not is not stepped."""
PATIENT_ANSWER = 1.5
"""Seconds of wall time after which a node that does not answer is taken not to be spun."""
TURNS = 3
"""Turns of an executor after which it has called the timers that a new time makes due.

It takes the time in one and calls the timers in the next. And where it looks at its subscriptions a moment before the
time arrives, and at its services a moment after the question has, the first turn is about the question alone.
"""
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


STEP = 0.05
"""Simulated seconds a step: small beside any period of the course, so that a period is seen to this precision."""
FIRST = 100.0
"""Simulated seconds at the start. The jump to it distorts the first interval, which nobody counts."""
SLOW_STEP = 0.25
"""Seconds of wall time after which a step is suspicious: the subject sleeps, or the machine is overloaded."""
STANDSTILL = 0.06
"""Seconds of wall time for which the clock stands still before it is stepped."""


class SimulatedClock:
    """Steps the clock of one node.

    Attributes:
        doubtful: A step took so long, or somebody else moved the clock too, that what was seen must be confirmed in
            real time.
    """

    def __init__(self, wire: Wire, recorder: Recorder, node: NodeName) -> None:
        self.doubtful = False
        self._recorder = recorder
        self._now = FIRST
        self._clock = NodeClock(wire, recorder, node)

    def take_over(self) -> bool:
        """Make the node follow simulated time.

        Returns:
            Whether it said yes, hears the clock and its executor answers. A True does not yet prove that its
            timers follow: :meth:`stands_still` does.
        """
        if not (self._clock.follow(True) and self._clock.is_heard()):
            return False
        self._recorder.simulated_now = self._now
        return self._clock.show(self._now)

    def stands_still(self, silent: Callable[[], bool]) -> bool:
        """Hold the clock for a moment; whether the subject stays silent as long.

        Args:
            silent: Tells whether nothing was heard since it was made.
        """
        self._recorder.wait(lambda: not silent(), STANDSTILL)
        return silent()

    def run(self, seconds: float, until: Callable[[], bool]) -> bool:
        """Step through ``seconds`` of simulated time or until something holds.

        Returns:
            Whether the subject's executor answered after each step.
        """
        end = self._now + seconds
        while self._now < end and not until():
            began = time.monotonic()
            self._now = round(self._now + STEP, 6)
            self._recorder.simulated_now = self._now
            if not self._clock.show(self._now):
                self.doubtful = True
                return False
            # Where somebody else moves the clock, simulated time says nothing about the subject's rate.
            slow = time.monotonic() - began > SLOW_STEP
            self.doubtful = self.doubtful or slow or self._clock.is_rivalled()
        return True

    def close(self) -> None:
        """Stop publishing and asking."""
        self._recorder.simulated_now = None
        self._clock.close()


BORROWED_STEP = 0.1
"""Simulated seconds a step of borrowed time. What a timer does more often is done in real time before anybody looks."""


class BorrowedTime:
    """Steps the clock of one node that lives in real time: its timers fire as they would later on.

    What a program does by its timers in the next seconds is seen in milliseconds. Its clock goes on from where it is,
    and is given back afterwards, so nothing that it has begun is lost. What does not follow a clock (a thread that
    sleeps) is not seen so.
    """

    def __init__(self, wire: Wire, recorder: Recorder, node: NodeName) -> None:
        self._clock = NodeClock(wire, recorder, node)

    def let_pass(self, seconds: float, until: Callable[[], bool]) -> bool:
        """Let simulated seconds pass, or fewer where ``until`` holds, and give the node its own time back.

        Returns:
            Whether the node went along: it took the clock, and answered after each step.
        """
        began = time.time()
        try:
            if not (self._clock.follow(True) and self._clock.is_heard() and self._clock.show(began)):
                return False
            steps = round(seconds / BORROWED_STEP)
            return all(
                until() or self._clock.show(began + BORROWED_STEP * step) for step in range(1, steps + 1)
            )
        finally:
            self._clock.follow(False)

    def close(self) -> None:
        """Take away what was made for this."""
        self._clock.close()
