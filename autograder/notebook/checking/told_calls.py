"""Tells the judge when a subject looks for a server, calls a service or sends a goal.

The judge cannot see from outside the kernel that a subject queries the graph. Nor can it see a request that was sent
before the judge's server existed, because such a request is lost.
"""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING, Any, Self

from rclpy.action import ActionClient
from rclpy.client import Client
from rclpy.node import Node

from autograder.messages.checks import Called, Looked

if TYPE_CHECKING:
    from collections.abc import Callable

TOLD: tuple[tuple[Any, str, type[Looked | Called]], ...] = (
    (Node, "get_service_names_and_types", Looked),
    (Node, "get_service_names_and_types_by_node", Looked),
    (Client, "service_is_ready", Looked),
    (ActionClient, "server_is_ready", Looked),
    (Client, "call_async", Called),
    (ActionClient, "send_goal_async", Called),
)
"""The methods whose calls are reported, each with the message that reports a call. rclpy's blocking methods, such as
``wait_for_service`` and ``call``, use these methods, too.
"""
LOOKS_TOLD = 10
"""How often per run the judge is told, at most, that the subject looks for a server. A loop without a pause looks
thousands of times a second.
"""


class ToldCalls:
    """Reports the subject's calls of the methods in :data:`TOLD` to the judge, within a ``with`` block."""

    def __init__(self, is_subject: Callable[[], bool], tell: Callable[..., None]) -> None:
        """Set up reporting. Entering the ``with`` block starts it.

        Args:
            is_subject: Returns True if the calling thread belongs to the subject.
            tell: Sends the judge a message about this run, given the message's class and fields.
        """
        self._is_subject = is_subject
        self._tell = tell
        self._looks = 0

    def begin_run(self) -> None:
        """Reset the counter that :data:`LOOKS_TOLD` limits. Call this before each run."""
        self._looks = 0

    def __enter__(self) -> Self:
        self._usual = [(owner, name, getattr(owner, name)) for owner, name, _ in TOLD]
        for owner, name, kind in TOLD:
            setattr(owner, name, self._told(getattr(owner, name), kind))
        return self

    def __exit__(self, *_: object) -> None:
        for owner, name, method in self._usual:
            setattr(owner, name, method)

    def _told(self, method: Callable[..., Any], kind: type[Looked | Called]) -> Callable[..., Any]:
        @functools.wraps(method)
        def told(*arguments: Any, **options: Any) -> Any:
            answer = method(*arguments, **options)
            if self._is_subject():
                self._looks += kind is Looked
                if kind is Called or self._looks <= LOOKS_TOLD:
                    self._tell(kind)
            return answer

        return told
