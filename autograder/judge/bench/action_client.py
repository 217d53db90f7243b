"""An action client of the judge's: it sends goals to the subject's server and writes down all that comes back.

It is made of the three services and the feedback topic that an action consists of (design.ros2.org, "Actions"), so that
each answer is seen as it was sent, a refused cancel request among them.
"""

from __future__ import annotations

import time
import uuid
from typing import TYPE_CHECKING, Any

from action_msgs.msg import GoalInfo
from action_msgs.srv import CancelGoal
from rclpy.qos import QoSProfile
from unique_identifier_msgs.msg import UUID

from autograder.judge.bench.action_server import goal_text
from autograder.judge.bench.interfaces import filled, interface, to_data

if TYPE_CHECKING:
    from collections.abc import Callable

    from autograder.judge.bench.recorder import Recorder
    from autograder.judge.bench.wire import Wire

GRAPH_POLL = 0.004
"""Seconds between two looks for a server."""


class RecordedActionClient:
    """Implements :class:`autograder.kit.counterparts.ActionCaller`."""

    def __init__(
        self,
        wire: Wire,
        recorder: Recorder,
        action: str,
        type_name: str,
        *,
        server_is_gone: Callable[[], bool],
    ) -> None:
        self._wire = wire
        self._recorder = recorder
        self._name = action
        self._server_is_gone = server_is_gone
        self._goals: list[UUID] = []
        node, self._parts = wire.node, interface(type_name).Impl
        # Made first: endpoints are announced in order, so a server that can answer the services knows this one, too,
        # and no first feedback is lost.
        self._feedback = node.create_subscription(
            self._parts.FeedbackMessage,
            f"{action}/_action/feedback",
            self._hear,  # type: ignore[arg-type]  # rclpy gives the message info to whoever takes two arguments
            QoSProfile(depth=100),
        )
        self._send = node.create_client(self._parts.SendGoalService, f"{action}/_action/send_goal")
        self._cancel = node.create_client(CancelGoal, f"{action}/_action/cancel_goal")
        self._result = node.create_client(self._parts.GetResultService, f"{action}/_action/get_result")

    def await_server(self, within: float) -> bool:
        """Wait until a server's services are matched, and write down how many servers there are."""
        self._recorder.wait(lambda: self._ready() or self._server_is_gone(), within, poll=GRAPH_POLL)
        self._note_servers()
        return self._ready()

    def send_goal(self, **fields: Any) -> int:
        """Send a goal; its number."""
        number = len(self._goals)
        self._goals.append(UUID(uuid=list(uuid.uuid4().bytes)))
        request = self._parts.SendGoalService.Request(goal_id=self._goals[number])
        filled(request.goal, fields)
        self._recorder.record("goal_sent", self._name, goal=number, fields=dict(fields))
        future = self._send.call_async(request)
        future.add_done_callback(lambda done: self._take_answer(number, done.result()))
        return number

    def cancel(self, goal: int) -> None:
        """Ask to cancel a goal."""
        self._recorder.record("cancel_sent", self._name, goal=goal)
        request = CancelGoal.Request(goal_info=GoalInfo(goal_id=self._goals[goal]))
        future = self._cancel.call_async(request)
        future.add_done_callback(lambda done: self._take_cancel_answer(goal, done.result()))

    def close(self) -> None:
        """Take the client away."""
        for client in (self._send, self._cancel, self._result):
            self._wire.node.destroy_client(client)
        self._wire.node.destroy_subscription(self._feedback)

    def _ready(self) -> bool:
        clients = (self._send, self._cancel, self._result)
        talks = self._wire.node.count_publishers(f"{self._name}/_action/feedback") > 0
        return talks and all(client.service_is_ready() for client in clients)

    def _note_servers(self) -> None:
        count = self._wire.node.count_services(f"{self._name}/_action/send_goal")
        self._recorder.record("servers", self._name, count=count)

    def _take_answer(self, number: int, response: Any) -> None:
        self._note("goal_answer", number, accepted=bool(response.accepted))
        if response.accepted:
            request = self._parts.GetResultService.Request(goal_id=self._goals[number])
            future = self._result.call_async(request)
            future.add_done_callback(lambda done: self._take_result(number, done.result()))

    def _take_result(self, number: int, response: Any) -> None:
        self._note_servers()
        fields = to_data(response.result)
        self._note("result_heard", number, status=int(response.status), fields=fields)

    def _take_cancel_answer(self, number: int, response: Any) -> None:
        named = {goal_text(info.goal_id) for info in response.goals_canceling}
        accepted = goal_text(self._goals[number]) in named
        code = int(response.return_code)
        self._note("cancel_answer", number, accepted=accepted, return_code=code)

    def _note(self, kind: str, goal: int, **data: Any) -> None:
        """Write down what the server answered; what has a later time of sending was surely sent after it."""
        self._recorder.record(kind, self._name, goal=goal, arrived=time.time(), **data)

    def _hear(self, message: Any, info: Any) -> None:
        known = [goal_text(goal) for goal in self._goals]
        heard = goal_text(message.goal_id)
        number = known.index(heard) if heard in known else -1
        # When it was sent is not blurred by how busy this process is (rmw_message_info_t).
        sent = info["source_timestamp"] / 1e9
        self._recorder.record(
            "feedback_heard", self._name, goal=number, fields=to_data(message.feedback), sent=sent
        )
