"""Counts the messages on topics, without waking up for each message."""

from __future__ import annotations

import importlib
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy

from autograder.notebook.observing.ros_graph import ChannelKind, GraphChannel

if TYPE_CHECKING:
    from collections.abc import Iterable

    from rclpy.node import Node
    from rclpy.subscription import Subscription

MOST = 200
"""The maximum number of messages on a topic that can be counted between two calls of :meth:`TopicTraffic.look`. If
there are more, the rate is only a lower bound.
"""
ANY = QoSProfile(
    depth=MOST,
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
    """Counts messages with a node that is not spun. Messages wait in the middleware until :meth:`look` takes them."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self._counted: dict[GraphChannel, _Counted | None] = {}

    def look(self, channels: Iterable[GraphChannel]) -> dict[GraphChannel, float]:
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
        subscription = self._node.create_subscription(kind, channel.name, lambda _: None, ANY, raw=True)
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
        while count < MOST and subscription.handle.take_message(subscription.msg_type, True) is not None:
            count += 1
    return count


def _rounded(rate: float) -> float:
    """Return a rate, rounded to a whole number or a half, so that a steady rate does not change in the picture."""
    return round(rate) if rate >= 5 else round(rate * 2) / 2
