"""A class that makes a second node of its own name: a check spins the class, and the second one has the timer."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rclpy.node import Node
from std_msgs.msg import String

if TYPE_CHECKING:
    from tests.notebook.checked import Checked


class TwinNode(Node):
    """A talker whose publisher and timer belong to a node that nothing spins."""

    def __init__(self) -> None:
        super().__init__("talker_node")
        self.node = Node("talker_node")
        self.publisher = self.node.create_publisher(String, "chatter", 10)
        self.node.create_timer(0.5, lambda: self.publisher.publish(String(data="Hello, world! 0")))


def test_a_second_node_of_the_same_name_is_named(checked: Checked) -> None:
    diagnosis = checked("lab_1_2.talker", TwinNode).diagnosis
    assert diagnosis is not None
    assert diagnosis.key == "never_published"
    assert "Two nodes are called talker_node" in diagnosis.text
