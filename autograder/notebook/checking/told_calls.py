"""Tells the judge when a subject looks for a server, calls a service or sends a goal.

The judge cannot see from outside that a subject looks at the graph. A request that is sent before its server exists is
lost, so the judge cannot see that request either.
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
"""The methods that are told of, and the message that tells of each. rclpy's own waits for a server and blocking calls
use these methods, too."""
LOOKS_TOLD = 10
"""Looks that are told of in one run; a loop without a pause makes thousands in a second."""


class ToldCalls:
    """Tells the judge of the subject's calls of :data:`TOLD` within a ``with`` block."""

    def __init__(self, is_subject: Callable[[], bool], tell: Callable[..., None]) -> None:
        """Prepare.

        Args:
            is_subject: Whether the thread that calls is one of the subject's.
            tell: Tells the judge a kind of message of this run.
        """
        self._is_subject = is_subject
        self._tell = tell
        self._looks = 0

    def begin_run(self) -> None:
        """Count the looks of the next run from zero."""
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
