"""Waits of a subject that need not be as long while it is checked.

A student reads the verdict in the cell, so no time is spent where nothing can happen. What rclpy itself waits is cut to
the moment at which it ends: ``wait_for_service`` and ``wait_for_server`` sleep a quarter of a second at a time
(rclpy/client.py and rclpy/action/client.py, "the sleep time is arbitrary"). What the subject sleeps is shortened only
where the scenario asks for it, in a look that is confirmed in real time where it fails.
"""

from __future__ import annotations

import math
import time
from typing import TYPE_CHECKING, Any, Self

import rclpy.action.client
import rclpy.client
from rclpy.action import ActionClient
from rclpy.client import Client

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import ModuleType, TracebackType

READY_POLL = 0.004
"""Seconds between two looks whether a server is there."""
SHORT = 0.02
"""Seconds of sleep that are never made shorter: short sleeps do not cost much and keep a loop from running hot."""


class Hurry:
    """Shortens waits within a ``with`` block; puts everything back at its end.

    Attributes:
        factor: What a sleep of the subject's is multiplied with; 1.0 leaves it alone.
    """

    def __init__(self, is_subject: Callable[[], bool]) -> None:
        """Prepare.

        Args:
            is_subject: Whether the thread that asks is one of the subject's.
        """
        self.factor = 1.0
        self._is_subject = is_subject

    def __enter__(self) -> Self:
        self._usual = (time.sleep, Client.wait_for_service, ActionClient.wait_for_server)
        usual_sleep = time.sleep

        def sleep(seconds: float, /) -> None:
            if self.factor < 1.0 and seconds > SHORT and self._is_subject():
                seconds = max(SHORT, seconds * self.factor)
            usual_sleep(seconds)

        def wait_for_service(client: Any, timeout_sec: float | None = None) -> bool:
            deadline = _deadline(timeout_sec)
            while client.context.ok() and not client.service_is_ready() and time.monotonic() < deadline:
                usual_sleep(READY_POLL)
            return bool(client.service_is_ready())

        def wait_for_server(client: Any, timeout_sec: float | None = None) -> bool:
            deadline = _deadline(timeout_sec)
            while client._node.context.ok() and not client.server_is_ready() and time.monotonic() < deadline:
                usual_sleep(READY_POLL)
            return bool(client.server_is_ready())

        _seem_to_be_in(rclpy.client, wait_for_service)
        _seem_to_be_in(rclpy.action.client, wait_for_server)
        _put(sleep, wait_for_service, wait_for_server)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        _put(*self._usual)


def _put(sleep: Any, wait_for_service: Any, wait_for_server: Any) -> None:
    for owner, name, function in (
        (time, "sleep", sleep),
        (Client, "wait_for_service", wait_for_service),
        (ActionClient, "wait_for_server", wait_for_server),
    ):
        setattr(owner, name, function)


def _deadline(timeout_sec: float | None) -> float:
    return math.inf if timeout_sec is None else time.monotonic() + timeout_sec


def _seem_to_be_in(module: ModuleType, function: Any) -> None:
    """Let the stack of a hung subject name the function as if it were rclpy's, which the judge knows."""
    function.__code__ = function.__code__.replace(co_filename=str(module.__file__))
