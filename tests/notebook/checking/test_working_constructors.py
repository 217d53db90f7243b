"""Node classes of a notebook that work inside their constructor: they are judged as they are as programs."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

import pytest
import rclpy
from my_robot_interfaces.srv import AddTwoInts
from rclpy.node import Node
from std_msgs.msg import String

if TYPE_CHECKING:
    from tests.notebook.checked import Checked, Diagnosed

pytestmark = [pytest.mark.ros, pytest.mark.slow]


def say(message: String) -> None:
    """What a listener does with each message."""
    print(message.data)


class Talker(Node):
    period = 0.5

    def __init__(self) -> None:
        super().__init__("talker_node")
        publisher = self.create_publisher(String, "chatter", 10)
        count = 0
        while True:
            publisher.publish(String(data=f"Hello, world! {count}"))
            count += 1
            time.sleep(self.period)


class HurriedTalker(Talker):
    period = 0.3


class Listener(Node):
    def __init__(self) -> None:
        super().__init__("listener_node")
        self.create_subscription(String, "chatter", say, 10)
        rclpy.spin(self)


class Adder(Node):
    def __init__(self) -> None:
        super().__init__("add_two_ints_server")
        self.create_service(AddTwoInts, "add_two_ints", self.add)
        while rclpy.ok():
            rclpy.spin_once(self)

    def add(self, request: AddTwoInts.Request, response: AddTwoInts.Response) -> AddTwoInts.Response:
        response.sum = request.a + request.b
        return response


class DeafListener(Node):
    def __init__(self) -> None:
        super().__init__("listener_node")
        self.create_subscription(String, "chatter", say, 10)
        while True:
            time.sleep(0.1)


@pytest.mark.parametrize(
    ("exercise", "node"),
    [("lab_1_2.talker", Talker), ("lab_1_2.listener", Listener), ("lab_1_3.server", Adder)],
)
def test_what_works_in_its_constructor_passes_with_a_word_on_it(
    exercise: str, node: type[Node], checked: Checked
) -> None:
    verdict = checked(exercise, node)
    assert verdict.passed, [f"{c.name}: {c.seen}" for c in verdict.criteria if not c.passed]
    assert any("does its work inside its __init__" in remark for remark in verdict.remarks)


@pytest.mark.parametrize(
    ("exercise", "node", "key"),
    [("lab_1_2.talker", HurriedTalker, "wrong_rate"), ("lab_1_2.listener", DeafListener, "never_ended")],
)
def test_what_is_wrong_there_is_told(exercise: str, node: type[Node], key: str, diagnosed: Diagnosed) -> None:
    assert diagnosed(exercise, node).key == key
