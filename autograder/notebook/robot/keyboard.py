"""Drives the robot by keyboard: JupyterLab calls :func:`drive` for the arrow keys, and a node publishes the command."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import TYPE_CHECKING

import rclpy
from geometry_msgs.msg import Twist, Vector3

from autograder.notebook.nodes.kernel_nodes import is_destroyed

if TYPE_CHECKING:
    from rclpy.node import Node
    from rclpy.publisher import Publisher

NAME = "keyboard"
"""The name of the node that publishes the commands. ``draw_graph`` shows it next to the robot."""
_DISCOVERY = 1.0
"""Time limit in seconds for discovering the robot. After that, the student is told that no robot listens."""


@dataclass(frozen=True)
class _Keyboard:
    node: Node
    publisher: Publisher
    made: float

    @property
    def is_gone(self) -> bool:
        return is_destroyed(self.node) or not self.node.context.ok()

    @property
    def finds_no_robot(self) -> bool:
        return time.monotonic() > self.made + _DISCOVERY and not self.publisher.get_subscription_count()


_keyboard: _Keyboard | None = None


def drive(forward: float, turn: float) -> str:
    """Publish one command on ``/cmd_vel``.

    Args:
        forward: Speed in meters per second.
        turn: Turning speed in radians per second, to the left.

    Returns:
        A message for the student if there is no robot; otherwise an empty text.
    """
    global _keyboard
    if not rclpy.ok():
        return "ROS is not started: run the cell with start_ros() first."
    if _keyboard is None or _keyboard.is_gone:
        node = rclpy.create_node(NAME, start_parameter_services=False)
        _keyboard = _Keyboard(node, node.create_publisher(Twist, "/cmd_vel", 10), time.monotonic())
    _keyboard.publisher.publish(Twist(linear=Vector3(x=float(forward)), angular=Vector3(z=float(turn))))
    if _keyboard.finds_no_robot:
        return "No robot listens to /cmd_vel: run the cell with start_robot() again."
    return ""
