"""The events of a launch, for event handlers."""

from __future__ import annotations

from typing import TYPE_CHECKING

from . import process
from .base import Event

if TYPE_CHECKING:
    from collections.abc import Callable

    from ..action import Action

__all__ = ["Event", "Shutdown", "TimerEvent", "matches_action", "process"]


class Shutdown(Event):
    """The event that the launch ends."""

    name = "launch.events.Shutdown"

    def __init__(self, *, reason: str = "reason not given", due_to_sigint: bool = False) -> None:
        self.reason = reason
        self.due_to_sigint = due_to_sigint


class TimerEvent(Event):
    """The event that the time of a timer has come."""

    name = "launch.events.TimerEvent"


def matches_action(target_action: Action) -> Callable[[Action], bool]:
    """Return a function that recognizes one action."""
    return lambda action: action is target_action
