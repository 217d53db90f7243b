"""The judge's side of actions: a server that does only what the scenario tells it to, and a client that sends goals.

Both record what they send and receive. They use the three services and two topics of an action directly
(design.ros2.org, "Actions"), because rclpy's classes hide too much: its ActionServer decides by itself when to answer,
and does not report a second request to cancel the same goal. The server of this module answers when the scenario says
so, and records each request. The client records each answer, including the refusal to cancel a goal.
"""

from __future__ import annotations

import threading
import time
import uuid
from functools import partial
from typing import TYPE_CHECKING, Any

from action_msgs.msg import GoalInfo, GoalStatus, GoalStatusArray
from action_msgs.srv import CancelGoal
from rclpy.qos import QoSProfile, qos_profile_action_status_default
from unique_identifier_msgs.msg import UUID

from autograder.judge.bench.recorded_services import Client
from autograder.judge.bench.ros_interfaces import filled, interface, to_data

if TYPE_CHECKING:
    from collections.abc import Callable

    from autograder.judge.bench.recorded_services import Send
    from autograder.judge.bench.recorder import Place


STATUS = {
    "accepted": GoalStatus.STATUS_ACCEPTED,
    "executing": GoalStatus.STATUS_EXECUTING,
    "canceling": GoalStatus.STATUS_CANCELING,
    "succeeded": GoalStatus.STATUS_SUCCEEDED,
    "canceled": GoalStatus.STATUS_CANCELED,
    "aborted": GoalStatus.STATUS_ABORTED,
}

_ENDED = (GoalStatus.STATUS_SUCCEEDED, GoalStatus.STATUS_CANCELED, GoalStatus.STATUS_ABORTED)
_SERVICES = ("send_goal", "cancel_goal", "get_result")
FEEDBACK_MATCH = 3.0
"""Time limit in seconds for discovering the subscription to feedback, without which feedback would be lost."""


class ScriptedActionServer:
    """An action server that accepts all goals, or refuses all goals. Its methods use the goal that was accepted last.

    Attributes:
        services: The full names of the action's services.
    """

    def __init__(
        self,
        place: Place,
        client_is_gone: Callable[[], bool],
        *,
        accept_goal: bool = True,
        accept_cancel: bool = True,
        goal_answer_takes: float = 0.0,
        cancel_answer_takes: float = 0.0,
    ) -> None:
        self._place, self._client_is_gone = place, client_is_gone
        parts_of = f"{place.at}/_action"
        self.services = tuple(f"{parts_of}/{name}" for name in _SERVICES)
        self._type = interface(place.type_name)
        self._accept_goal, self._goal_answer_takes = accept_goal, goal_answer_takes
        self._accept_cancel, self._cancel_answer_takes = accept_cancel, cancel_answer_takes
        self._goal_id: Any = None
        self._status = GoalStatus.STATUS_UNKNOWN
        self._lock = threading.Lock()
        self._result: Any = None
        self._waiting: list[Send] = []
        self._is_closed = False
        node, parts = place.wire.node, self._type.Impl
        self._feedback = node.create_publisher(
            parts.FeedbackMessage, f"{parts_of}/feedback", QoSProfile(depth=10)
        )
        self._statuses = node.create_publisher(
            GoalStatusArray, f"{parts_of}/status", qos_profile_action_status_default
        )
        kinds = (parts.SendGoalService, CancelGoal, parts.GetResultService)
        takes = (self._take_goal, self._take_cancel, self._take_result_request)
        self._services = [
            node.create_service(kind, name, take)  # type: ignore[misc]
            for kind, name, take in zip(kinds, self.services, takes, strict=True)
        ]

    def await_goal(self, within: float) -> bool:
        """Wait until a goal has arrived and was answered. Return False if no goal came within ``within`` seconds.

        This also waits until the client's subscription to feedback is discovered, because earlier feedback would be
        lost.
        """
        if not self._await("goal", within):
            return False
        self._await("goal_answered", within)
        self._place.recorder.wait(
            lambda: self._feedback.get_subscription_count() > 0 or self._client_is_gone(),
            FEEDBACK_MATCH,
            poll=0.005,
        )
        return True

    def await_cancel(self, within: float) -> bool:
        """Wait for a request to cancel a goal. Return False if none came within ``within`` seconds of wall time."""
        return self._await("cancel", within, wall=True)

    def await_result_request(self, within: float) -> bool:
        """Wait for a request for a goal's result. Return False if no request came within ``within`` seconds."""
        return self._await("result_request", within)

    def send_feedback(self, **fields: Any) -> None:
        """Send one feedback message for the current goal."""
        feedback = filled(self._type.Feedback, fields, f"The feedback of {self._place.name}")
        message = self._type.Impl.FeedbackMessage(goal_id=self._goal_id, feedback=feedback)
        self._place.record("feedback", fields=dict(fields))
        self._feedback.publish(message)

    def finish(self, status: str, **fields: Any) -> None:
        """End the current goal with a status (a key of :data:`STATUS`) and a result that has these fields."""
        result = filled(self._type.Result, fields, f"The result of {self._place.name}")
        response = self._type.Impl.GetResultService.Response(status=STATUS[status], result=result)
        self._place.record("result", status=status, fields=dict(fields))
        self._set_status(STATUS[status])
        with self._lock:
            self._result = response
            waiting, self._waiting = self._waiting, []
        for send in waiting:
            send(response)

    def close(self) -> None:
        self._is_closed = True
        for service in self._services:
            self._place.wire.node.destroy_service(service)
        for publisher in (self._feedback, self._statuses):
            self._place.wire.node.destroy_publisher(publisher)

    def _await(self, kind: str, within: float, *, wall: bool = False) -> bool:
        def came() -> bool:
            return self._place.recorder.part().first(kind, self._place.name) is not None

        self._place.recorder.wait(lambda: came() or self._client_is_gone(), within, wall=wall)
        return came()

    def _take_goal(self, request: Any, send: Send) -> None:
        stamp = self._place.wire.node.get_clock().now().to_msg()
        response = self._type.Impl.SendGoalService.Response(accepted=self._accept_goal, stamp=stamp)
        if self._accept_goal:
            self._goal_id = request.goal_id
            self._result = None
            self._status = GoalStatus.STATUS_EXECUTING
        self._place.record("goal", fields=to_data(request.goal))
        self._answer("goal_answered", self._accept_goal, response, send, self._goal_answer_takes)

    def _answer(self, kind: str, accepted: bool, response: Any, send: Send, seconds: float) -> None:
        """Record and send an answer, after some seconds of wall time. Meanwhile, the server takes further requests."""

        def answer() -> None:
            if not self._is_closed:
                self._place.record(kind, accepted=accepted)
                send(response)

        if seconds <= 0.0:
            answer()
            return
        timer = threading.Timer(seconds, answer)
        timer.daemon = True
        timer.start()

    def _take_cancel(self, request: Any, send: Send) -> None:
        # An all-zero id and stamp mean "cancel every goal" (action_msgs/srv/CancelGoal).
        asked = _goal_text(request.goal_info.goal_id)
        every = asked == str(uuid.UUID(int=0))
        known = self._goal_id is not None and (every or asked == _goal_text(self._goal_id))
        accepted = self._accept_cancel and known and self._status in (
            GoalStatus.STATUS_EXECUTING, GoalStatus.STATUS_CANCELING)  # fmt: skip
        response = CancelGoal.Response()
        if accepted:
            self._set_status(GoalStatus.STATUS_CANCELING)
            response.goals_canceling = [GoalInfo(goal_id=self._goal_id)]
            response.return_code = CancelGoal.Response.ERROR_NONE
        else:
            response.return_code = (
                CancelGoal.Response.ERROR_REJECTED if known else CancelGoal.Response.ERROR_UNKNOWN_GOAL_ID
            )
        self._place.record("cancel", accepted=accepted, known=known, every=every)
        self._answer("cancel_answered", accepted, response, send, self._cancel_answer_takes)

    def _take_result_request(self, request: Any, send: Send) -> None:
        known = self._goal_id is not None and _goal_text(request.goal_id) == _goal_text(self._goal_id)
        self._place.record("result_request", known=known)
        if known:
            self.say_status()
        with self._lock:
            if known and self._result is None:
                self._waiting.append(send)
                return
        unknown = self._type.Impl.GetResultService.Response(status=GoalStatus.STATUS_UNKNOWN)
        send(self._result if known else unknown)

    def _set_status(self, status: int) -> None:
        self._status = status
        self.say_status()

    def say_status(self) -> None:
        """Publish the current goal's status on the action's status topic.

        The server calls this itself when the status changes or the client requests the result, but not when it accepts
        a goal. A client has to learn from the server's answer whether its goal was accepted. A client that reads the
        status instead finds UNKNOWN, the first status of rclpy's goal handles, and so cannot pass by chance.
        """
        line = GoalStatus(goal_info=GoalInfo(goal_id=self._goal_id), status=self._status)
        self._statuses.publish(GoalStatusArray(status_list=[line]))


def _goal_text(goal_id: Any) -> str:
    """Return a goal's id (``unique_identifier_msgs/msg/UUID``) as text."""
    return str(uuid.UUID(bytes=bytes(bytearray(int(b) & 0xFF for b in goal_id.uuid))))


class RecordedActionClient(Client):
    """An action client that records events. It implements :class:`autograder.kit.counterparts.ActionCaller`."""

    def __init__(self, place: Place, server_is_gone: Callable[[], bool]) -> None:
        self._parts_of = f"{place.at}/_action"
        super().__init__(place, f"{self._parts_of}/send_goal", server_is_gone)
        self._goals: dict[int, UUID] = {}
        self._numbers: dict[str, int] = {}
        self._ended: set[int] = set()
        self._type = interface(place.type_name)
        node, self._parts = place.wire.node, self._type.Impl
        # The feedback subscription is made before the clients. Endpoints are announced in order, so a server that has
        # discovered the clients has also discovered this subscription, and no feedback is lost.
        self._feedback = node.create_subscription(
            self._parts.FeedbackMessage,
            f"{self._parts_of}/feedback",
            self._hear,  # type: ignore[arg-type]  # a callback with two parameters also gets the message info
            QoSProfile(depth=100),
        )
        self._statuses = node.create_subscription(
            GoalStatusArray,
            f"{self._parts_of}/status",
            self._hear_statuses,  # type: ignore[arg-type]  # as above
            qos_profile_action_status_default,
        )
        self._send = node.create_client(self._parts.SendGoalService, f"{self._parts_of}/send_goal")
        self._cancel = node.create_client(CancelGoal, f"{self._parts_of}/cancel_goal")
        self._result = node.create_client(self._parts.GetResultService, f"{self._parts_of}/get_result")

    def send_goal(self, number: int | None = None, /, **fields: Any) -> int:
        """Send a goal with these fields. Return the goal's number, by default counted from 0."""
        goal = filled(self._type.Goal, fields, self._place.name)
        number = len(self._goals) if number is None else number
        self._goals[number] = goal_id = UUID(uuid=list(uuid.uuid4().bytes))
        self._numbers[_goal_text(goal_id)] = number
        request = self._parts.SendGoalService.Request(goal_id=goal_id, goal=goal)
        self._place.record("goal_sent", goal=number, fields=dict(fields))
        self._place.wire.executor.ask(self._send, request, partial(self._take_answer, number))
        return number

    def cancel(self, goal: int) -> None:
        """Request to cancel a goal."""
        self._place.record("cancel_sent", goal=goal)
        request = CancelGoal.Request(goal_info=GoalInfo(goal_id=self._goals[goal]))
        self._place.wire.executor.ask(self._cancel, request, partial(self._take_cancel_answer, goal))

    def close(self) -> None:
        for client in (self._send, self._cancel, self._result):
            self._place.wire.node.destroy_client(client)
        for subscription in (self._feedback, self._statuses):
            self._place.wire.node.destroy_subscription(subscription)

    def _ready(self) -> bool:
        clients = (self._send, self._cancel, self._result)
        talks = self._place.wire.node.count_publishers(f"{self._parts_of}/feedback") > 0
        return talks and all(client.service_is_ready() for client in clients)

    def _take_answer(self, number: int, response: Any) -> None:
        self._note("goal_answer", number, accepted=bool(response.accepted))
        if response.accepted:
            request = self._parts.GetResultService.Request(goal_id=self._goals[number])
            self._place.wire.executor.ask(self._result, request, partial(self._take_result, number))

    def _take_result(self, number: int, response: Any) -> None:
        self._note_servers()
        fields = to_data(response.result)
        self._note("result_heard", number, status=int(response.status), fields=fields)

    def _take_cancel_answer(self, number: int, response: Any) -> None:
        named = {_goal_text(info.goal_id) for info in response.goals_canceling}
        accepted = _goal_text(self._goals[number]) in named
        code = int(response.return_code)
        self._note("cancel_answer", number, accepted=accepted, return_code=code)

    def _note(self, kind: str, goal: int, **data: Any) -> None:
        """Record an answer of the server, with the time of its arrival."""
        self._place.record(kind, goal=goal, arrived=time.time(), **data)

    def _hear(self, message: Any, info: Any) -> None:
        number = self._number_of(message.goal_id)
        # Record the time of sending (rmw_message_info_t), which does not depend on how busy the judge is.
        sent = info["source_timestamp"] / 1e9
        self._place.record("feedback_heard", goal=number, fields=to_data(message.feedback), sent=sent)

    def _hear_statuses(self, message: Any, info: Any) -> None:
        """Record, for each goal, when the server said for the first time that the goal has ended."""
        sent = info["source_timestamp"] / 1e9
        for line in message.status_list:
            number, status = self._number_of(line.goal_info.goal_id), int(line.status)
            if status in _ENDED and number >= 0 and number not in self._ended:
                self._ended.add(number)
                self._place.record("goal_ended", goal=number, status=status, sent=sent)

    def _number_of(self, goal_id: Any) -> int:
        """Return the number of a goal; -1 if the goal is not the judge's."""
        return self._numbers.get(_goal_text(goal_id), -1)
