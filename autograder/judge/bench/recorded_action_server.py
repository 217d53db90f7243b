"""An action that the judge serves: each goal has feedback and an end of its own, in the subject's time."""

from __future__ import annotations

import threading
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from action_msgs.msg import GoalInfo, GoalStatus, GoalStatusArray
from action_msgs.srv import CancelGoal
from rclpy.qos import QoSProfile, qos_profile_action_status_default

from autograder.judge.bench.recorded_actions import STATUS
from autograder.judge.bench.ros_interfaces import filled, interface, to_data

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from unique_identifier_msgs.msg import UUID

    from autograder.judge.bench.recorded_services import Send
    from autograder.judge.bench.recorder import Place
    from autograder.kit.counterparts import Work

EVERY = bytes(16)
"""The id of a request to cancel every goal (action_msgs/srv/CancelGoal)."""


@dataclass
class _Goal:
    """A goal that was accepted.

    Attributes:
        number: Its number, counted from 1.
        work: What the judge does with it.
        began: When it was accepted, in the subject's time.
        told: The number of feedback messages so far.
        result: The answer to requests for the result; None while the goal runs.
        waiting: The requests for the result that wait for it.
    """

    number: int
    goal_id: Any
    work: Work
    began: float
    told: int = 0
    result: Any = None
    waiting: list[Send] = field(default_factory=list)


class RecordedActionServer:
    """An action that accepts several goals at once, ends each of them by itself, and records what it sends and gets.

    Attributes:
        services: The full names of the action's services.
    """

    def __init__(self, place: Place, work: Callable[[Mapping[str, Any]], Work]) -> None:
        """Create the action.

        Args:
            work: Returns what to do with a goal that has these fields.
        """
        self._place, self._work = place, work
        self._type = interface(place.type_name)
        self._goals: dict[bytes, _Goal] = {}
        self._count = 0
        self._lock = threading.RLock()
        node, parts, at = place.wire.node, self._type.Impl, f"{place.at}/_action"
        self._feedback = node.create_publisher(parts.FeedbackMessage, f"{at}/feedback", QoSProfile(depth=10))
        self._statuses = node.create_publisher(
            GoalStatusArray, f"{at}/status", qos_profile_action_status_default
        )
        served = {
            "send_goal": (parts.SendGoalService, self._take_goal),
            "cancel_goal": (CancelGoal, self._take_cancel),
            "get_result": (parts.GetResultService, self._take_result_request),
        }
        self.services = tuple(f"{at}/{name}" for name in served)
        # The executor gives each callback a function that sends, and no response.
        self._services = [
            node.create_service(kind, f"{at}/{name}", take)  # type: ignore[misc]
            for name, (kind, take) in served.items()
        ]

    def answer_due(self) -> None:
        """Send the feedback that is due, and end the goals whose time is over."""
        with self._lock:
            for goal in [goal for goal in self._goals.values() if goal.result is None]:
                passed = self._place.recorder.moment - goal.began
                for fields in goal.work.feedback[goal.told : goal.work.told_after(passed)]:
                    self._tell(goal, fields)
                if passed >= goal.work.takes:
                    self._end(goal, goal.work.status)

    def close(self) -> None:
        for service in self._services:
            self._place.wire.node.destroy_service(service)
        for publisher in (self._feedback, self._statuses):
            self._place.wire.node.destroy_publisher(publisher)

    def _take_goal(self, request: Any, send: Send) -> None:
        fields = to_data(request.goal)
        with self._lock:
            self._count += 1
            work = self._work(fields)
            self._place.record("goal", number=self._count, fields=fields)
            if work.accepts:
                began = self._place.recorder.moment
                self._goals[_key(request.goal_id)] = _Goal(self._count, request.goal_id, work, began)
            self._place.record("goal_answered", number=self._count, accepted=work.accepts)
        stamp = self._place.wire.node.get_clock().now().to_msg()
        send(self._type.Impl.SendGoalService.Response(accepted=work.accepts, stamp=stamp))

    def _tell(self, goal: _Goal, fields: Mapping[str, Any]) -> None:
        goal.told += 1
        feedback = filled(self._type.Feedback, fields, f"The feedback of {self._place.name}")
        self._place.record("feedback", number=goal.number, fields=dict(fields))
        self._feedback.publish(self._type.Impl.FeedbackMessage(goal_id=goal.goal_id, feedback=feedback))

    def _take_cancel(self, request: Any, send: Send) -> None:
        key = _key(request.goal_info.goal_id)
        response = CancelGoal.Response(return_code=CancelGoal.Response.ERROR_UNKNOWN_GOAL_ID)
        with self._lock:
            asked = list(self._goals.values()) if key == EVERY else [self._goals[key]] * (key in self._goals)
            running = [goal for goal in asked if goal.result is None]
            for goal in asked:
                self._place.record("cancel", number=goal.number, accepted=goal in running)
            if running:
                response.return_code = CancelGoal.Response.ERROR_NONE
                response.goals_canceling = [GoalInfo(goal_id=goal.goal_id) for goal in running]
            elif asked:
                response.return_code = CancelGoal.Response.ERROR_GOAL_TERMINATED
        send(response)
        with self._lock:
            for goal in running:
                self._end(goal, "canceled")

    def _take_result_request(self, request: Any, send: Send) -> None:
        with self._lock:
            goal = self._goals.get(_key(request.goal_id))
            self._place.record("result_request", known=goal is not None)
            if goal is not None and goal.result is None:
                goal.waiting.append(send)
                return
        unknown = self._type.Impl.GetResultService.Response(status=GoalStatus.STATUS_UNKNOWN)
        send(unknown if goal is None else goal.result)

    def _end(self, goal: _Goal, status: str) -> None:
        result = filled(self._type.Result, goal.work.result, f"The result of {self._place.name}")
        goal.result = self._type.Impl.GetResultService.Response(status=STATUS[status], result=result)
        self._place.record("result", number=goal.number, status=status, fields=dict(goal.work.result))
        line = GoalStatus(goal_info=GoalInfo(goal_id=goal.goal_id), status=STATUS[status])
        self._statuses.publish(GoalStatusArray(status_list=[line]))
        for send in goal.waiting:
            send(goal.result)


def _key(goal_id: UUID) -> bytes:
    return bytes(bytearray(goal_id.uuid))
