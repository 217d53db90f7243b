"""Nodes that the judge puts on the graph for a subject to look at."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rclpy.context import Context
from rclpy.node import Node
from rclpy.qos import QoSProfile

from autograder.judge.interfaces import interface
from autograder.ros_participant import receivers_wait

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping


class Bed:
    """Participants for planted nodes, one for each node that is there at once.

    A node needs a participant of its own, as in one participant Fast DDS takes only one type for a topic. The
    participants stay from part to part, as a subject that stays needs a fifth of a second and more to meet a new one.
    """

    def __init__(self, domain_id: int) -> None:
        self._domain_id = domain_id
        self._free: list[_Plot] = []

    def plant(self, name: str, *, publishes: Mapping[str, str], subscribes: Mapping[str, str]) -> PlantedNode:
        """Put a node with these endpoints on the graph."""
        plot = self._free.pop(0) if self._free else _Plot(self._domain_id)
        return PlantedNode(plot, self._free.append, name, publishes=publishes, subscribes=subscribes)

    def close(self) -> None:
        """Leave the domain. The nodes must have been taken off the graph."""
        while self._free:
            self._free.pop().close()


class _Plot:
    """A participant, kept by a hidden node that does nothing."""

    def __init__(self, domain_id: int) -> None:
        self.context = Context()
        self.context.init(args=["--ros-args", "--disable-external-lib-logs"], domain_id=domain_id)
        with receivers_wait():
            self._keeper = Node(
                "_check_bed",
                context=self.context,
                use_global_arguments=False,
                enable_rosout=False,
                start_parameter_services=False,
            )

    def close(self) -> None:
        self._keeper.destroy_node()
        self.context.try_shutdown()
        self.context.destroy()


class PlantedNode:
    """A node with the given endpoints, as any node of the course has them; nothing spins it."""

    def __init__(
        self,
        plot: _Plot,
        give_back: Callable[[_Plot], None],
        name: str,
        *,
        publishes: Mapping[str, str],
        subscribes: Mapping[str, str],
    ) -> None:
        self._plot = plot
        self._give_back = give_back
        self._node = Node(name, context=plot.context, use_global_arguments=False)
        for topic, type_name in publishes.items():
            self._node.create_publisher(interface(type_name), topic, QoSProfile(depth=10))
        for topic, type_name in subscribes.items():
            self._node.create_subscription(interface(type_name), topic, lambda _: None, QoSProfile(depth=10))

    def close(self) -> None:
        """Take it off the graph."""
        self._node.destroy_node()
        self._give_back(self._plot)
