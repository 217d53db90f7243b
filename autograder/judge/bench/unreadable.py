"""What a subject does that no judge can read. It ends the look, and the check has failed."""

from __future__ import annotations

import contextlib
import functools
from typing import TYPE_CHECKING

import re2

if TYPE_CHECKING:
    from collections.abc import Iterator

FLOOD, NAME = "flood", "name"
"""Too many events; a name on the graph that ROS does not allow."""
_FULL_NAME = re2.compile(r"(/[A-Za-z_][A-Za-z0-9_]*)+")
"""Matches the full name of a node, topic, service or action (design.ros2.org, "Topic and Service name mapping")."""


class UnreadableSubject(Exception):
    """The judge cannot read what the subject does.

    Attributes:
        why: :data:`FLOOD` or :data:`NAME`.
    """

    def __init__(self, why: str) -> None:
        super().__init__(why)
        self.why = why


@functools.lru_cache(maxsize=4096)
def checked(name: str) -> str:
    """Return a full name on the ROS graph.

    No ROS library makes another name, but a program can change the bytes of a name in its own memory.

    Raises:
        UnreadableSubject: ROS does not allow the name.
    """
    if not _FULL_NAME.fullmatch(name):
        raise UnreadableSubject(NAME)
    return name


@contextlib.contextmanager
def names_are_read() -> Iterator[None]:
    """Read names on the ROS graph in the block, or in the decorated function.

    Raises:
        UnreadableSubject: A name is not valid UTF-8; rclpy then raises UnicodeDecodeError.
    """
    try:
        yield
    except UnicodeDecodeError as error:
        raise UnreadableSubject(NAME) from error
