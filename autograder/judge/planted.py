"""Nodes that the judge puts on the graph for a subject to look at."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rclpy.node import Node
from rclpy.qos import QoSProfile

from autograder.judge.interfaces import interface

if TYPE_CHECKING:
    from collections.abc import Mapping

    from autograder.judge.wire import Wire


class PlantedNode:
    """A node with the given endpoints, as any node of the course has them; nothing spins it."""

    def __init__(
        self, wire: Wire, name: str, *, publishes: Mapping[str, str], subscribes: Mapping[str, str]
    ) -> None:
        self._node = Node(name, context=wire.context, use_global_arguments=False)
        for topic, type_name in publishes.items():
            self._node.create_publisher(interface(type_name), topic, QoSProfile(depth=10))
        for topic, type_name in subscribes.items():
            self._node.create_subscription(interface(type_name), topic, lambda _: None, QoSProfile(depth=10))

    def close(self) -> None:
        """Take it off the graph."""
        self._node.destroy_node()
