"""The running graph as plain data: which nodes there are, and what connects them."""

from __future__ import annotations

import time
from contextlib import contextmanager
from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING

import rclpy
from rclpy.action import (
    get_action_client_names_and_types_by_node,
    get_action_server_names_and_types_by_node,
)
from rclpy.node import NodeNameNonExistentError

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from rclpy.node import Node

READER = "_graph_reader"
"""The name of the node that looks; names that begin with an underscore are hidden in ROS."""

SETTLING = 0.05
"""Seconds between two looks that must agree: a node's ends are announced one after the other."""

# Every node has these; they say nothing about what it does (rclpy/node.py, parameter_service.py).
_EVERY_TOPIC = {"/rosout", "/parameter_events"}
_EVERY_SERVICE = {
    "describe_parameters",
    "get_parameter_types",
    "get_parameters",
    "get_type_description",
    "list_parameters",
    "set_parameters",
    "set_parameters_atomically",
}


class Kind(StrEnum):
    """What connects nodes."""

    TOPIC = "topic"
    SERVICE = "service"
    ACTION = "action"


@dataclass(frozen=True, order=True)
class Channel:
    """A topic, a service or an action."""

    kind: Kind
    name: str
    type: str


@dataclass(frozen=True, order=True)
class End:
    """A node's end of a channel.

    Attributes:
        node: The node's full name, such as ``/talker``.
        channel: What it is an end of.
        gives: Whether the node publishes, or is the client; otherwise it subscribes, or is the server.
    """

    node: str
    channel: Channel
    gives: bool


@dataclass(frozen=True)
class RosGraph:
    """What one look at the graph has shown, each in order of the names."""

    nodes: tuple[str, ...]
    ends: tuple[End, ...]

    @property
    def channels(self) -> tuple[Channel, ...]:
        """The topics, services and actions that have an end."""
        return tuple(sorted({end.channel for end in self.ends}))

    def sentences(self) -> list[str]:
        """The graph in words, a sentence for each node."""
        return [self._sentence(node) for node in self.nodes] or ["No node is running."]

    def _sentence(self, node: str) -> str:
        parts = [
            f"{_VERBS[end.channel.kind, end.gives]} {end.channel.name} ({end.channel.type})"
            for end in self.ends
            if end.node == node
        ]
        return f"{node} {', '.join(parts) or 'is connected to nothing'}."


_VERBS = {
    (Kind.TOPIC, True): "publishes on",
    (Kind.TOPIC, False): "subscribes to",
    (Kind.SERVICE, True): "calls the service",
    (Kind.SERVICE, False): "serves",
    (Kind.ACTION, True): "sends goals to the action",
    (Kind.ACTION, False): "serves the action",
}


def read_graph(patience: float = 2.0) -> RosGraph:
    """Look at the graph of this kernel's ROS domain.

    Args:
        patience: Seconds to wait for two looks in a row that agree. Where the graph keeps changing, the last
            look counts.
    """
    deadline = time.monotonic() + patience
    with _reader() as node:
        seen = _look(node)
        while True:
            time.sleep(SETTLING)
            before, seen = seen, _look(node)
            if seen == before or time.monotonic() > deadline:
                return seen


@contextmanager
def _reader() -> Iterator[Node]:
    node = rclpy.create_node(READER, enable_rosout=False, start_parameter_services=False)
    try:
        yield node
    finally:
        node.destroy_node()


def _look(node: Node) -> RosGraph:
    pairs = [
        (name, space) for name, space in node.get_node_names_and_namespaces() if not name.startswith("_")
    ]
    ends = {end for name, space in pairs for end in _ends(node, name, space)}
    return RosGraph(tuple(sorted({_full(*pair) for pair in pairs})), tuple(sorted(ends)))


def _full(name: str, space: str) -> str:
    return f"{space.rstrip('/')}/{name}"


def _ends(node: Node, name: str, space: str) -> Iterator[End]:
    """The ends of one node. A node that has just gone has none."""
    topics, services = Kind.TOPIC, Kind.SERVICE
    try:
        found = [
            (topics, True, node.get_publisher_names_and_types_by_node(name, space)),
            (topics, False, node.get_subscriber_names_and_types_by_node(name, space)),
            (services, True, node.get_client_names_and_types_by_node(name, space)),
            (services, False, node.get_service_names_and_types_by_node(name, space)),
            (Kind.ACTION, True, get_action_client_names_and_types_by_node(node, name, space)),
            (Kind.ACTION, False, get_action_server_names_and_types_by_node(node, name, space)),
        ]
    except NodeNameNonExistentError:
        return
    for kind, gives, names_and_types in found:
        for channel in _channels(kind, names_and_types):
            yield End(_full(name, space), channel, gives)


def _channels(kind: Kind, names_and_types: Iterable[tuple[str, list[str]]]) -> Iterator[Channel]:
    for name, types in names_and_types:
        last = name.rpartition("/")[2]
        common = (
            name in _EVERY_TOPIC if kind is Kind.TOPIC else kind is Kind.SERVICE and last in _EVERY_SERVICE
        )
        # An action's own topics and services are below <action>/_action.
        hidden = any(part.startswith("_") for part in name.split("/"))
        if not common and not hidden:
            yield from (Channel(kind, name, type_name) for type_name in types)
