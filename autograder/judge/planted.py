"""Nodes that the judge puts on the graph for a subject to look at."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rclpy.context import Context
from rclpy.node import Node
from rclpy.qos import QoSProfile

from autograder.judge.interfaces import interface
from autograder.ros_participant import receivers_wait

if TYPE_CHECKING:
    from collections.abc import Mapping

    from autograder.judge.wire import Wire


class PlantedNode:
    """A node with the given endpoints, as any node of the course has them; nothing spins it."""

    def __init__(
        self, wire: Wire, name: str, *, publishes: Mapping[str, str], subscribes: Mapping[str, str]
    ) -> None:
        # A participant of its own: in one participant Fast DDS takes only one type for a topic.
        self._context = Context()
        self._context.init(
            args=["--ros-args", "--disable-external-lib-logs"], domain_id=wire.context.get_domain_id()
        )
        with receivers_wait():
            self._node = Node(name, context=self._context, use_global_arguments=False)
        for topic, type_name in publishes.items():
            self._node.create_publisher(interface(type_name), topic, QoSProfile(depth=10))
        for topic, type_name in subscribes.items():
            self._node.create_subscription(interface(type_name), topic, lambda _: None, QoSProfile(depth=10))

    def close(self) -> None:
        """Take it off the graph."""
        self._node.destroy_node()
        self._context.try_shutdown()
        self._context.destroy()
