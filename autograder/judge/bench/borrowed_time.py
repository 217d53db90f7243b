"""A moment of simulated time for a subject that lives in real time: its timers fire as they would later on.

What a program does by its timers in the next seconds is seen in milliseconds. Its clock goes on from where it is, and
is given back afterwards, so nothing that it has begun is lost. What does not follow a clock (a thread that sleeps) is
not seen so.
"""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import GetParameters, SetParameters
from rclpy.qos import QoSProfile
from rosgraph_msgs.msg import Clock

from autograder.judge.bench.clock import ANSWER_LIMIT, ask

if TYPE_CHECKING:
    from collections.abc import Callable

    from autograder.judge.bench.graph import NodeName
    from autograder.judge.bench.recorder import Recorder
    from autograder.judge.bench.wire import Wire

STEP = 0.1
"""Simulated seconds a step. What a timer does more often than that is done in real time before anybody looks."""
_SIM_TIME = "use_sim_time"


class BorrowedTime:
    """Moves the clock of one node of the subject's."""

    def __init__(self, wire: Wire, recorder: Recorder, node: NodeName) -> None:
        self._wire = wire
        self._recorder = recorder
        self._publisher = wire.node.create_publisher(Clock, "/clock", QoSProfile(depth=10))
        self._set = wire.node.create_client(SetParameters, f"{node.full}/set_parameters")
        self._get = wire.node.create_client(GetParameters, f"{node.full}/get_parameters")

    def let_pass(self, seconds: float, until: Callable[[], bool]) -> bool:
        """Let simulated seconds pass, or fewer where ``until`` holds, and give the node its own time back.

        Returns:
            Whether the node went along: it took the clock, and answered after each step.
        """
        began = time.time()
        try:
            if not (self._follow(True) and self._hears() and self._show(began)):
                return False
            steps = round(seconds / STEP)
            return all(until() or self._show(began + STEP * step) for step in range(1, steps + 1))
        finally:
            self._follow(False)

    def close(self) -> None:
        """Take away what was made for this."""
        self._wire.node.destroy_publisher(self._publisher)
        self._wire.node.destroy_client(self._set)
        self._wire.node.destroy_client(self._get)

    def _follow(self, simulated: bool) -> bool:
        value = ParameterValue(type=ParameterType.PARAMETER_BOOL, bool_value=simulated)
        request = SetParameters.Request(parameters=[Parameter(name=_SIM_TIME, value=value)])
        answer = self._ask(self._set, request)
        return answer is not None and bool(answer.results) and bool(answer.results[0].successful)

    def _hears(self) -> bool:
        return self._recorder.wait(
            lambda: self._publisher.get_subscription_count() > 0, ANSWER_LIMIT, poll=0.002
        )

    def _show(self, now: float) -> bool:
        """Publish the time; whether the node's executor has turned twice since, and so called what was due by it."""
        message = Clock()
        message.clock.sec, rest = int(now), now - int(now)
        message.clock.nanosec = int(rest * 1e9)
        self._publisher.publish(message)
        question = GetParameters.Request(names=[_SIM_TIME])
        return all(self._ask(self._get, question) is not None for _ in range(2))

    def _ask(self, client: Any, request: Any) -> Any:
        return ask(self._recorder, client, request, ANSWER_LIMIT)
