"""Node classes of a notebook that make their endpoint once they are spun: they are right, as they are as programs."""

from __future__ import annotations

import sys
import threading
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
from my_robot_interfaces.action import Fibonacci
from my_robot_interfaces.srv import AddTwoInts
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.lifecycle import LifecycleNode, LifecycleState, TransitionCallbackReturn
from rclpy.node import Node
from std_msgs.msg import String

sys.path.insert(0, str(Path(__file__).parents[1]))
from checked import a_judge

if TYPE_CHECKING:
    from rclpy.action.server import ServerGoalHandle

    from tests.notebook.checked import Checked

pytestmark = [pytest.mark.ros, pytest.mark.slow]

LARGEST = 46
"""The largest order whose numbers fit into the result."""


def say(message: String) -> None:
    """What a listener does with each message."""
    print(message.data)


class _Starting(Node):
    """A node that makes what it is for in the first call of a timer."""

    def __init__(self, name: str) -> None:
        super().__init__(name)
        self._boot = self.create_timer(0.0, self._begin)

    def _begin(self) -> None:
        self._boot.cancel()
        self.configure()

    def configure(self) -> None:
        """Make what the node is for."""
        raise NotImplementedError


class Talker(_Starting):
    def __init__(self) -> None:
        super().__init__("talker_node")
        self.number = 0

    def configure(self) -> None:
        self.talking = self.create_publisher(String, "chatter", 10)
        self.create_timer(0.5, self.talk)

    def talk(self) -> None:
        self.talking.publish(String(data=f"Hello, world! {self.number}"))
        self.number += 1


class TalkerAtItsFirstTick(Node):
    def __init__(self) -> None:
        super().__init__("talker_node")
        self.talking: Any = None
        self.number = 0
        self.create_timer(0.5, self.talk)

    def talk(self) -> None:
        if self.talking is None:
            self.talking = self.create_publisher(String, "chatter", 10)
        self.talking.publish(String(data=f"Hello, world! {self.number}"))
        self.number += 1


class Listener(_Starting):
    def __init__(self) -> None:
        super().__init__("listener_node")

    def configure(self) -> None:
        self.create_subscription(String, "chatter", say, 10)


class ListenerOfAThread(Node):
    def __init__(self) -> None:
        super().__init__("listener_node")
        threading.Timer(0.2, self.configure).start()

    def configure(self) -> None:
        self.create_subscription(String, "chatter", say, 10)


class ManagedListener(LifecycleNode):
    def __init__(self) -> None:
        super().__init__("listener_node")
        self._boot = self.create_timer(0.0, self._begin)

    def _begin(self) -> None:
        self._boot.cancel()
        self.trigger_configure()  # type: ignore[no-untyped-call]
        self.trigger_activate()  # type: ignore[no-untyped-call]

    def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:
        self.create_subscription(String, "chatter", say, 10)
        return TransitionCallbackReturn.SUCCESS


class Adder(_Starting):
    def __init__(self) -> None:
        super().__init__("add_two_ints_server")

    def configure(self) -> None:
        self.create_service(AddTwoInts, "add_two_ints", self.add)

    def add(self, request: AddTwoInts.Request, response: AddTwoInts.Response) -> AddTwoInts.Response:
        response.sum = request.a + request.b
        return response


class Fibonaccis(_Starting):
    def __init__(self) -> None:
        super().__init__("fibonacci_action_server")

    def configure(self) -> None:
        self.serving = ActionServer(
            self,
            Fibonacci,
            "fibonacci",
            self.execute,
            goal_callback=lambda goal: (
                GoalResponse.ACCEPT if 0 <= goal.order <= LARGEST else GoalResponse.REJECT
            ),
            cancel_callback=lambda _: CancelResponse.ACCEPT,
        )

    def execute(self, handle: ServerGoalHandle) -> Fibonacci.Result:
        numbers = [0, 1]
        for _ in range(1, handle.request.order):
            if handle.is_cancel_requested:
                handle.canceled()
                return Fibonacci.Result(sequence=numbers)
            numbers.append(numbers[-1] + numbers[-2])
            handle.publish_feedback(Fibonacci.Feedback(partial_sequence=numbers))
            time.sleep(0.5)
        handle.succeed()
        return Fibonacci.Result(sequence=numbers[: handle.request.order + 1])


@pytest.mark.parametrize(
    ("exercise", "node"),
    [
        ("lab_1_2.talker", Talker),
        ("lab_1_2.talker", TalkerAtItsFirstTick),
        ("lab_1_2.listener", Listener),
        ("lab_1_2.listener", ListenerOfAThread),
        ("lab_1_2.listener", ManagedListener),
        ("lab_1_3.server", Adder),
        ("lab_1_4.server", Fibonaccis),
    ],
)
def test_a_node_may_make_its_endpoint_once_it_is_spun(
    exercise: str, node: type[Node], checked: Checked
) -> None:
    verdict = checked(exercise, node)
    assert verdict.passed, [f"{c.name}: {c.seen}" for c in verdict.criteria if not c.passed]


class NothingYet(Node):
    def __init__(self) -> None:
        super().__init__("a_node")


PATIENT = """
from autograder.judge.bench import subject_presence
subject_presence.SETTLED = dict.fromkeys(subject_presence.SETTLED, 60.0)
subject_presence.APPEAR = 60.0
"""
"""Makes a judge wait a minute for whatever may still come."""
SOON = 30.0
"""Seconds that are less than such a wait."""


@pytest.mark.parametrize(
    "exercise", ["lab_1_2.talker", "lab_1_2.listener", "lab_1_3.server", "lab_1_4.server"]
)
def test_a_node_that_can_make_nothing_more_is_not_waited_for(exercise: str) -> None:
    with a_judge(change=PATIENT) as checked:
        began = time.monotonic()
        verdict = checked(exercise, NothingYet)
        took = time.monotonic() - began
    assert verdict.diagnosis is not None
    assert verdict.diagnosis.key == "not_written"
    assert took < SOON
