"""Functions of a notebook that return a node, instead of a class: they are judged as the class would be."""

from __future__ import annotations

from itertools import count
from queue import Queue
from typing import TYPE_CHECKING

import pytest
import rclpy
from rclpy.node import Node
from std_msgs.msg import String

from autograder.notebook.checking.subject_runs import SubjectRun

if TYPE_CHECKING:
    from autograder.messages.json_lines import Message
    from tests.notebook.checked import Checked

pytestmark = [pytest.mark.ros, pytest.mark.slow]


def talker(period: float = 0.5) -> Node:
    node = rclpy.create_node("talker_node")
    publisher, numbers = node.create_publisher(String, "chatter", 10), count()
    node.create_timer(period, lambda: publisher.publish(String(data=f"Hello, world! {next(numbers)}")))
    return node


def hurried() -> Node:
    return talker(0.3)


def test_a_function_that_returns_a_node_is_as_good_as_a_class(checked: Checked) -> None:
    assert checked("lab_1_2.talker", talker).passed
    wrong = checked("lab_1_2.talker", hurried)
    assert wrong.diagnosis is not None
    assert wrong.diagnosis.key == "wrong_rate"


def test_a_node_that_is_destroyed_is_a_value_like_any_other() -> None:
    told: Queue[Message] = Queue()

    def client() -> Node:
        node = Node("client", context=context)
        node.destroy_node()
        return node

    context = rclpy.Context()
    rclpy.init(context=context)
    run = SubjectRun(1, client, context, told.put)
    run.start((), {})
    names = [type(told.get(timeout=30.0)).__name__ for _ in range(2)]
    assert run.stop()
    rclpy.shutdown(context=context)
    assert names == ["Started", "Returned"]
