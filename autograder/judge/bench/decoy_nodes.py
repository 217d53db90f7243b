"""Decoys: nodes that the judge puts on the graph only for a subject to find. They have endpoints, but do nothing."""

from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING

from rclpy.context import Context
from rclpy.node import Node
from rclpy.qos import QoSProfile

from autograder.judge.bench.graph import topic_endpoints
from autograder.judge.bench.interfaces import interface
from autograder.ros_participant import receivers_wait

if TYPE_CHECKING:
    from collections.abc import Mapping

    from autograder.judge.bench.graph import Endpoint


class DecoyNodes:
    """The judge's decoy nodes, each with its own DDS participant.

    Each node needs its own participant, because within one participant Fast DDS accepts only one type for each topic.
    Participants are kept from part to part, because a subject that keeps running needs a fifth of a second or more to
    discover a new participant. A participant exists only as long as it has a node (rmw_fastrtps), so an old node is
    removed only when the next node exists.
    """

    def __init__(self, domain_id: int) -> None:
        self._domain_id = domain_id
        self._decoys: list[_Decoy] = []
        self._planted = 0

    def plant(
        self, name: str, *, publishes: Mapping[str, str], subscribes: Mapping[str, str]
    ) -> set[Endpoint]:
        """Put a node on the graph, with publishers and subscriptions for these topics. The node is not spun.

        Returns:
            The identifiers of the node's endpoints on these topics.
        """
        if self._planted == len(self._decoys):
            self._decoys.append(_Decoy(self._domain_id))
        decoy = self._decoys[self._planted]
        self._planted += 1
        return decoy.plant(name, publishes, subscribes)

    def clear(self) -> None:
        """Remove the endpoints from the graph. The nodes stay until the next decoys replace them."""
        for decoy in self._decoys[: self._planted]:
            decoy.clear()
        self._planted = 0

    def close(self) -> None:
        """Remove the decoy nodes and their participants."""
        while self._decoys:
            self._decoys.pop().close()


class _Decoy:
    """One DDS participant of the judge, with the decoy node that it currently shows on the graph."""

    def __init__(self, domain_id: int) -> None:
        self._context = Context()
        self._context.init(args=["--ros-args", "--disable-external-lib-logs"], domain_id=domain_id)
        self._node: Node | None = None
        self._ends = contextlib.ExitStack()

    def plant(self, name: str, publishes: Mapping[str, str], subscribes: Mapping[str, str]) -> set[Endpoint]:
        with receivers_wait() if self._node is None else contextlib.nullcontext():
            node = Node(name, context=self._context, use_global_arguments=False)
        self._destroy()
        self._node = node
        qos = QoSProfile(depth=10)
        for topic, type_name in publishes.items():
            publisher = node.create_publisher(interface(type_name), topic, qos)
            self._ends.callback(node.destroy_publisher, publisher)
        for topic, type_name in subscribes.items():
            subscription = node.create_subscription(interface(type_name), topic, lambda _: None, qos)
            self._ends.callback(node.destroy_subscription, subscription)
        return topic_endpoints(node, {*publishes, *subscribes})

    def clear(self) -> None:
        self._ends.close()

    def _destroy(self) -> None:
        self.clear()
        if self._node is not None:
            self._node.destroy_node()

    def close(self) -> None:
        self._destroy()
        self._context.try_shutdown()
        self._context.destroy()
