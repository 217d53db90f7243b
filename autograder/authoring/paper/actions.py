"""Actions on paper: the client of a program, and the action of the bench that takes its goals."""

from __future__ import annotations

import threading
from dataclasses import dataclass, field
from functools import partial
from math import isfinite
from typing import TYPE_CHECKING, Any
from uuid import uuid4

import rclpy.action
from action_msgs.msg import GoalInfo
from action_msgs.srv import CancelGoal
from rclpy.task import Future
from unique_identifier_msgs.msg import UUID

from autograder.authoring.paper.network import SECOND, Hangs, Network, UnknownOnPaper, wired
from autograder.judge.bench.recorded_actions import STATUS
from autograder.judge.bench.ros_interfaces import filled, interface, to_data

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from autograder.authoring.paper.bench import PaperBench
    from autograder.authoring.paper.nodes import PaperNode
    from autograder.kit.counterparts import Work


@dataclass(eq=False)
class Handle:
    """The handle of a goal, as a program gets it.

    Attributes:
        number: The number of the goal, counted from 1.
        kind: The type of the action.
        accepted: True if the goal was accepted.
        cancel: Cancels the goal; returns True if it was running.
        status: The status of the goal.
        result: The answer to requests for the result; None while the goal runs.
        waiting: The futures that wait for it.
    """

    number: int
    kind: Any
    accepted: bool
    cancel: Callable[[Handle], bool]
    status: int = 0
    result: Any = None
    waiting: list[Future] = field(default_factory=list)
    goal_id: UUID = field(default_factory=lambda: UUID(uuid=list(uuid4().bytes)))

    def get_result_async(self) -> Future:
        """Return the future of the result."""
        future = Future()
        self.waiting.append(future)
        self.give()
        return future

    def give(self) -> None:
        """Give the result to all that wait for it, if it is there."""
        if self.result is not None:
            waiting, self.waiting = self.waiting, []
            Network.now_running.pending.extend(partial(future.set_result, self.result) for future in waiting)

    def cancel_goal_async(self) -> Future:
        """Request to cancel the goal. Return the future of the answer."""
        future = Future()
        running = self.cancel(self)
        info = [GoalInfo(goal_id=self.goal_id)] * running
        answer = CancelGoal.Response(return_code=0 if running else 3, goals_canceling=info)
        Network.now_running.pending.append(partial(future.set_result, answer))
        return future


class PaperActionClient:
    """An action client of a program. Only actions of the bench take its goals."""

    def __init__(self, node: PaperNode, action_type: Any, action_name: str, **_: Any) -> None:
        self.kind, self.name = action_type, node.resolve_topic_name(action_name)
        Network.now_running.action_clients.append(self)

    def server_is_ready(self) -> bool:
        """Return True if the bench serves this action."""
        return self.name in Network.now_running.actions

    def wait_for_server(self, timeout_sec: float | None = None) -> bool:
        """Return True if the bench serves this action; otherwise the limit passes."""
        if not self.server_is_ready() and timeout_sec is None:
            raise Hangs
        return self.server_is_ready()

    def send_goal_async(self, goal: Any, feedback_callback: Any = None, goal_uuid: Any = None) -> Future:
        """Send a goal. Return the future of its handle."""
        if not isinstance(goal, self.kind.Goal):
            raise TypeError(f"expected {self.kind.Goal}, got {type(goal)}")
        if goal_uuid is not None or threading.current_thread() is not Network.now_running.main:
            raise UnknownOnPaper("a goal of a thread, or with an id")
        future, network = Future(), Network.now_running
        if take := network.actions.get(self.name):
            handle = take(wired(goal), partial(self._hear, feedback_callback))
            network.pending.append(partial(future.set_result, handle))
        return future

    def _hear(self, callback: Any, handle: Handle, feedback: Any) -> None:
        if callback is not None:
            message = self.kind.Impl.FeedbackMessage(goal_id=handle.goal_id, feedback=feedback)
            Network.now_running.pending.append(partial(Network.now_running.call, callback, message))


class PaperAction:
    """An action of the bench, which does with each goal what the exercise says.

    Args:
        bench: What records.
        name: The full name of the action.
        type_name: Its type.
        work: Returns what to do with a goal.
    """

    def __init__(
        self, bench: PaperBench, name: str, type_name: str, work: Callable[[Mapping[str, Any]], Work]
    ) -> None:
        self._bench, self._name, self._work, self._type = bench, name, work, interface(type_name)
        self._count = 0

    def take(self, goal: Any, hear: Callable[[Handle, Any], None]) -> Handle:
        """Take a goal, and return its handle."""
        fields, network = to_data(goal), Network.now_running
        work = self._work(fields)
        self._count += 1
        handle = Handle(self._count, self._type, work.accepts, partial(self._cancel, work))
        self._record("goal", handle, fields=fields)
        self._record("goal_answered", handle, accepted=work.accepts)
        for number, told in enumerate(work.feedback if work.accepts else (), 1):
            network.later(round(number * work.between * SECOND), partial(self._tell, handle, told, hear))
        if work.accepts and isfinite(work.takes):
            network.later(round(work.takes * SECOND), partial(self._end, handle, work, work.status))
        return handle

    def _record(self, kind: str, handle: Handle, **data: Any) -> None:
        self._bench.record(kind, self._name, number=handle.number, **data)

    def _tell(self, handle: Handle, fields: Mapping[str, Any], hear: Callable[[Handle, Any], None]) -> None:
        if handle.result is None:
            self._record("feedback", handle, fields=dict(fields))
            hear(handle, filled(self._type.Feedback, fields, self._name))

    def _cancel(self, work: Work, handle: Handle) -> bool:
        running = handle.result is None
        self._record("cancel", handle, accepted=running)
        self._end(handle, work, "canceled")
        return running

    def _end(self, handle: Handle, work: Work, status: str) -> None:
        if handle.result is None:
            handle.status = STATUS[status]
            result = filled(self._type.Result, work.result, self._name)
            handle.result = self._type.Impl.GetResultService.Response(status=handle.status, result=result)
            self._record("result", handle, status=status, fields=dict(work.result))
            handle.give()


def replace_actions() -> None:
    """Put the client on paper into the place of rclpy's, in this process for good."""
    rclpy.action.ActionClient = PaperActionClient  # type: ignore[misc,assignment]
