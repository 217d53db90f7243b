"""Finds the message class of a topic on the ROS graph."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

from course_runtime.ros2_command.interface_types import load_type

if TYPE_CHECKING:
    from rclpy.node import Node

_POLL = 0.02  # seconds


def type_on_graph(node: Node, topic: str) -> Any | None:
    """Return the message class of a topic; None if the topic does not exist.

    Raises:
        RuntimeError: The name is not valid, or the topic has several types or one that is not installed.
    """
    from rclpy.exceptions import InvalidTopicNameException
    from rclpy.expand_topic_name import expand_topic_name
    from rclpy.validate_full_topic_name import validate_full_topic_name

    try:
        full = expand_topic_name(topic, node.get_name(), node.get_namespace())
        validate_full_topic_name(full)
    except (ValueError, InvalidTopicNameException) as error:
        raise RuntimeError(str(error)) from error
    types = dict(node.get_topic_names_and_types()).get(full)
    if not types:
        return None
    if len(types) > 1:
        raise RuntimeError(
            f"Cannot echo topic '{topic}', as it contains more than one type: [{', '.join(types)}]"
        )
    try:
        return load_type(types[0], "msg")
    except ValueError as error:
        raise RuntimeError(f"The message type '{types[0]}' is invalid") from error


def message_class(node: Node, topic: str, *, wait: bool = False) -> Any | None:
    """Return the message class of a topic. If the topic does not exist, warn and, if requested, wait for it."""
    found = type_on_graph(node, topic)
    if found is not None:
        return found
    print(f"WARNING: topic [{topic}] does not appear to be published yet")
    while wait and node.context.ok():
        time.sleep(_POLL)
        if (found := type_on_graph(node, topic)) is not None:
            return found
    return None
