"""Nodes that the judge puts on the graph for a subject to look at."""

from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING

from rclpy.context import Context
from rclpy.node import Node
from rclpy.qos import QoSProfile

from autograder.judge.bench.interfaces import interface
from autograder.ros_participant import receivers_wait

if TYPE_CHECKING:
    from collections.abc import Mapping


class DecoyNodes:
    """Participants for planted nodes, one for each node that is there at once.

    A node needs a participant of its own, as in one participant Fast DDS takes only one type for a topic. The
    participants stay from part to part, as a subject that stays needs a fifth of a second and more to meet a new one.
    A participant lives as long as it has a node (rmw_fastrtps), so a node leaves only when the next one is there.
    """

    def __init__(self, domain_id: int) -> None:
        self._domain_id = domain_id
        self._decoys: list[_Decoy] = []
        self._planted = 0

    def plant(self, name: str, *, publishes: Mapping[str, str], subscribes: Mapping[str, str]) -> None:
        """Put a node with these endpoints on the graph, as any node of the course has them; nothing spins it."""
        if self._planted == len(self._decoys):
            self._decoys.append(_Decoy(self._domain_id))
        node = self._decoys[self._planted].plant(name)
        self._planted += 1
        for topic, type_name in publishes.items():
            node.create_publisher(interface(type_name), topic, QoSProfile(depth=10))
        for topic, type_name in subscribes.items():
            node.create_subscription(interface(type_name), topic, lambda _: None, QoSProfile(depth=10))

    def clear(self) -> None:
        """Let the nodes be replaced by those that are planted next."""
        self._planted = 0

    def close(self) -> None:
        """Take everything off the graph."""
        while self._decoys:
            self._decoys.pop().close()


class _Decoy:
    """A participant and the node that it has now."""

    def __init__(self, domain_id: int) -> None:
        self._context = Context()
        self._context.init(args=["--ros-args", "--disable-external-lib-logs"], domain_id=domain_id)
        self._node: Node | None = None

    def plant(self, name: str) -> Node:
        with receivers_wait() if self._node is None else contextlib.nullcontext():
            node = Node(name, context=self._context, use_global_arguments=False)
        self._destroy()
        self._node = node
        return node

    def _destroy(self) -> None:
        if self._node is not None:
            self._node.destroy_node()

    def close(self) -> None:
        self._destroy()
        self._context.try_shutdown()
        self._context.destroy()
