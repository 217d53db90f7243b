"""Reads the running graph as plain data: nodes, what connects them, and the rates of messages on topics."""

from __future__ import annotations

import importlib
import time
from contextlib import contextmanager
from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING, Any

import rclpy
from rclpy.action import (
    get_action_client_names_and_types_by_node,
    get_action_server_names_and_types_by_node,
)
from rclpy.node import NodeNameNonExistentError
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from rclpy.node import Node
    from rclpy.subscription import Subscription


READER = "_graph_reader"
"""The name of the node that reads the graph. It begins with an underscore, so that ROS hides the node."""

PATIENCE = 2.0
"""Seconds after which the last reading of the graph is used, even if no two successive readings were equal."""
SETTLING = 0.05
"""Seconds between two readings that are compared. The wait is needed because a node's endpoints are announced one by
one.
"""

# Every node of rclpy has these topics and services (rclpy/node.py, parameter_service.py). They are not shown.
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


class ChannelKind(StrEnum):
    """The kinds of connections between nodes."""

    TOPIC = "topic"
    SERVICE = "service"
    ACTION = "action"


@dataclass(frozen=True, order=True)
class GraphChannel:
    """A topic, service or action, with its type."""

    kind: ChannelKind
    name: str
    type: str


@dataclass(frozen=True, order=True)
class GraphEndpoint:
    """A node's connection to a topic, service or action, for example as a publisher.

    Attributes:
        node: The full name of the node, such as ``/talker``.
        channel: The topic, service or action.
        gives: True if the node is the publisher or client; False if it is the subscriber or server.
    """

    node: str
    channel: GraphChannel
    gives: bool


@dataclass(frozen=True)
class RosGraph:
    """The graph at one moment: nodes and connections, sorted by name."""

    nodes: tuple[str, ...]
    ends: tuple[GraphEndpoint, ...]

    @property
    def channels(self) -> tuple[GraphChannel, ...]:
        """The topics, services and actions that have at least one endpoint."""
        return tuple(sorted({end.channel for end in self.ends}))

    def sentences(self) -> list[str]:
        """Return the graph in words, one sentence for each node."""
        return [self._sentence(node) for node in self.nodes] or ["No node is running."]

    def _sentence(self, node: str) -> str:
        parts = [
            f"{_VERBS[end.channel.kind, end.gives]} {end.channel.name} ({end.channel.type})"
            for end in self.ends
            if end.node == node
        ]
        return f"{node} {', '.join(parts) or 'is connected to nothing'}."


_VERBS = {
    (ChannelKind.TOPIC, True): "publishes on",
    (ChannelKind.TOPIC, False): "subscribes to",
    (ChannelKind.SERVICE, True): "calls the service",
    (ChannelKind.SERVICE, False): "serves",
    (ChannelKind.ACTION, True): "sends goals to the action",
    (ChannelKind.ACTION, False): "serves the action",
}


def read_graph() -> RosGraph:
    """Return the graph of this kernel's ROS domain, once two successive readings are equal."""
    deadline = time.monotonic() + PATIENCE
    with _reader() as node:
        seen = graph_known_to(node)
        while True:
            time.sleep(SETTLING)
            before, seen = seen, graph_known_to(node)
            if seen == before or time.monotonic() > deadline:
                return seen


@contextmanager
def _reader() -> Iterator[Node]:
    node = hidden_node(READER)
    try:
        yield node
    finally:
        node.destroy_node()


def hidden_node(name: str) -> Node:
    """Return a new node that only observes. ``ros2 node list`` hides nodes whose names begin with an underscore."""
    return rclpy.create_node(name, enable_rosout=False, start_parameter_services=False)


def graph_known_to(node: Node) -> RosGraph:
    """Return the graph as the observing node knows it now, without hidden nodes."""
    pairs = [
        (name, space) for name, space in node.get_node_names_and_namespaces() if not name.startswith("_")
    ]
    nodes = {_full(*pair) for pair in pairs}
    ends = {end for end in _topic_ends(node) if end.node in nodes}
    ends |= {end for name, space in pairs for end in _service_and_action_ends(node, name, space)}
    return RosGraph(tuple(sorted(nodes)), tuple(sorted(ends)))


def _full(name: str, space: str) -> str:
    return f"{space.rstrip('/')}/{name}"


def _topic_ends(node: Node) -> Iterator[GraphEndpoint]:
    """Yield all publishers and subscriptions, with the names of their nodes.

    The query is by topic, because a query by node finds only one of two nodes that have the same name.
    """
    for topic, _ in node.get_topic_names_and_types():
        if not _is_shown_topic(topic):
            continue
        for gives, infos in (
            (True, node.get_publishers_info_by_topic(topic)),
            (False, node.get_subscriptions_info_by_topic(topic)),
        ):
            for info in infos:
                full = _full(info.node_name, info.node_namespace)
                yield GraphEndpoint(full, GraphChannel(ChannelKind.TOPIC, topic, info.topic_type), gives)


def _service_and_action_ends(node: Node, name: str, space: str) -> Iterator[GraphEndpoint]:
    """Yield a node's connections to services and actions; none if the node has just ended."""
    services, actions = ChannelKind.SERVICE, ChannelKind.ACTION
    try:
        found = [
            (services, True, node.get_client_names_and_types_by_node(name, space)),
            (services, False, node.get_service_names_and_types_by_node(name, space)),
            (actions, True, get_action_client_names_and_types_by_node(node, name, space)),
            (actions, False, get_action_server_names_and_types_by_node(node, name, space)),
        ]
    except NodeNameNonExistentError:
        return
    for kind, gives, names_and_types in found:
        for channel in _channels(kind, names_and_types):
            yield GraphEndpoint(_full(name, space), channel, gives)


def _channels(kind: ChannelKind, names_and_types: Iterable[tuple[str, list[str]]]) -> Iterator[GraphChannel]:
    for name, types in names_and_types:
        is_of_every_node = kind is ChannelKind.SERVICE and name.rpartition("/")[2] in _EVERY_SERVICE
        if not is_of_every_node and not _is_hidden(name):
            yield from (GraphChannel(kind, name, type_name) for type_name in types)


def _is_shown_topic(topic: str) -> bool:
    """Return False for the topics that every node has, and for hidden topics such as those of an action."""
    return topic not in _EVERY_TOPIC and not _is_hidden(topic)


def _is_hidden(name: str) -> bool:
    # The names of the topics and services of an action are hidden, too: they begin with <action>/_action.
    return any(part.startswith("_") for part in name.split("/"))


MOST_COUNTED = 200
"""The maximum number of messages on a topic that can be counted between two calls of :meth:`TopicTraffic.rates`. If
there are more, the rate is only a lower bound.
"""
UNDEMANDING_QOS = QoSProfile(
    depth=MOST_COUNTED,
    history=HistoryPolicy.KEEP_LAST,
    # The least demanding QoS matches every publisher.
    reliability=ReliabilityPolicy.BEST_EFFORT,
    durability=DurabilityPolicy.VOLATILE,
)


@dataclass
class _Counted:
    subscription: Subscription
    since: float


class TopicTraffic:
    """Counts messages with a node that is not spun. Messages wait in the middleware until :meth:`rates` takes them."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self._counted: dict[GraphChannel, _Counted | None] = {}

    def rates(self, channels: Iterable[GraphChannel]) -> dict[GraphChannel, float]:
        """Return the messages per second on each of these topics since the last call. New topics are left out."""
        wanted = {channel for channel in channels if channel.kind is ChannelKind.TOPIC}
        for channel in self._counted.keys() - wanted:
            self._forget(channel)
        rates = {}
        for channel in wanted:
            if channel not in self._counted:
                self._counted[channel] = self._subscribed(channel)
            elif (counted := self._counted[channel]) is not None:
                now = time.monotonic()
                rates[channel] = _rounded(_taken(counted.subscription) / max(now - counted.since, 1e-3))
                counted.since = now
        return rates

    def _subscribed(self, channel: GraphChannel) -> _Counted | None:
        try:
            kind = message_class(channel.type)
        except LookupError:
            return None
        subscription = self._node.create_subscription(
            kind, channel.name, lambda _: None, UNDEMANDING_QOS, raw=True
        )
        return _Counted(subscription, time.monotonic())

    def _forget(self, channel: GraphChannel) -> None:
        counted = self._counted.pop(channel)
        if counted is not None:
            self._node.destroy_subscription(counted.subscription)


def message_class(type_name: str) -> Any:
    """Return the class of a message type such as ``"std_msgs/msg/String"``.

    Raises:
        LookupError: The type is not installed in this environment.
    """
    try:
        package, kind, name = type_name.split("/")
        return getattr(importlib.import_module(f"{package}.{kind}"), name)
    except (ValueError, ImportError, AttributeError) as error:
        raise LookupError(f"the message type {type_name} is not installed here") from error


def _taken(subscription: Subscription) -> int:
    """Take the messages that have arrived, and return their number."""
    count = 0
    with subscription.handle:
        while (
            count < MOST_COUNTED and subscription.handle.take_message(subscription.msg_type, True) is not None
        ):
            count += 1
    return count


def _rounded(rate: float) -> float:
    """Return a rate, rounded to a whole number or a half, so that a steady rate does not change in the picture."""
    return round(rate) if rate >= 5 else round(rate * 2) / 2
