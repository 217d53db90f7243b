"""Simulated time: the judge publishes ``/clock`` and steps it, so that seconds cost milliseconds.

Each step is followed by a question to the subject's parameter service. The answer proves that its executor has turned
since the step, so the result does not depend on how busy the machine is. What does not follow the clock (a
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

STEP = 0.05
"""Simulated seconds a step: small beside any period of the course, so that a period is seen to this precision."""
FIRST = 100.0
"""Simulated seconds at the start. The jump to it distorts the first interval, which nobody counts."""
ANSWER_LIMIT = 0.5
"""Seconds of wall time in which a spinning node answers a question; one that does not is not stepped."""
PATIENT_ANSWER = 1.5
"""Seconds of wall time after which a node that does not answer is taken not to be spun."""
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
        self._wire = wire
        self._recorder = recorder
        self._now = FIRST
        self._publisher = wire.node.create_publisher(Clock, "/clock", QoSProfile(depth=10))
        self._set = wire.node.create_client(SetParameters, f"{node.full}/set_parameters")
        self._get = wire.node.create_client(GetParameters, f"{node.full}/get_parameters")

    def take_over(self) -> bool:
        """Make the node follow simulated time.

        Returns:
            Whether it said yes, hears the clock and its executor answers. A True does not yet prove that its
            timers follow: :meth:`stands_still` does.
        """
        value = ParameterValue(type=ParameterType.PARAMETER_BOOL, bool_value=True)
        request = SetParameters.Request(parameters=[Parameter(name="use_sim_time", value=value)])
        answer = self._ask(self._set, request)
        if answer is None or not answer.results or not answer.results[0].successful:
            return False
        hears = self._recorder.wait(
            lambda: self._publisher.get_subscription_count() > 0, ANSWER_LIMIT, poll=0.002
        )
        if not hears:
            return False
        self._recorder.simulated_now = self._now
        self._publish()
        return self._probe()

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
            self._publish()
            if not self._probe():
                self.doubtful = True
                return False
            self.doubtful = self.doubtful or time.monotonic() - began > SLOW_STEP or self._is_rivalled()
        return True

    def close(self) -> None:
        """Stop publishing and asking."""
        self._recorder.simulated_now = None
        self._wire.node.destroy_publisher(self._publisher)
        self._wire.node.destroy_client(self._set)
        self._wire.node.destroy_client(self._get)

    def _is_rivalled(self) -> bool:
        """Whether somebody else publishes on /clock: then simulated time says nothing about the subject's rate."""
        return self._wire.node.count_publishers("/clock") > 1

    def _publish(self) -> None:
        message = Clock()
        message.clock.sec = int(self._now)
        message.clock.nanosec = round((self._now - int(self._now)) * 1e9)
        self._publisher.publish(message)

    def _probe(self) -> bool:
        """Whether the subject's executor has turned twice since the last step.

        In its first turn it takes the new time, in the second it calls the timers that are due by it.
        """
        return all(self._ask(self._get, _QUESTION) is not None for _ in range(2))

    def _ask(self, client: Any, request: Any) -> Any:
        return ask(self._recorder, client, request, ANSWER_LIMIT)


_QUESTION = GetParameters.Request(names=["use_sim_time"])


def ask(recorder: Recorder, client: Any, request: Any, limit: float) -> Any:
    """The answer of a service of the subject's, or None where its executor does not turn within ``limit`` seconds."""
    if not recorder.wait(client.service_is_ready, limit, poll=0.005):
        return None
    future = client.call_async(request)
    done = threading.Event()
    future.add_done_callback(lambda _: done.set())
    patience = Patience(limit)
    while not done.is_set() and (left := patience.left) > 0:
        done.wait(left)
    return future.result() if done.is_set() else None


def answers(wire: Wire, recorder: Recorder, node: NodeName, limit: float = PATIENT_ANSWER) -> bool:
    """Whether a node answers, within ``limit`` seconds, a question that every spun node answers."""
    client = wire.node.create_client(GetParameters, f"{node.full}/get_parameters")
    try:
        return ask(recorder, client, _QUESTION, limit) is not None
    finally:
        wire.node.destroy_client(client)
