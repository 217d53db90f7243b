"""The event handlers that a launch file can use."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from .action import ProcessAction
from .event_handler import EventHandler
from .events import Shutdown
from .events.process import ProcessExited, ProcessIO, ProcessStarted
from .unsupported import names_elsewhere

if TYPE_CHECKING:
    from collections.abc import Callable

    from .launch_context import LaunchContext

__all__ = ["OnProcessExit", "OnProcessIO", "OnProcessStart", "OnShutdown"]
__getattr__ = names_elsewhere(
    "launch.event_handlers", ("OnExecutionComplete", "OnIncludeLaunchDescription", "event_named")
)


def _about(kind: type, target: Any) -> Callable[[Any], bool]:
    """Return a function that recognizes events of one kind about one action, or about those that the target accepts.

    Raises:
        TypeError: The target is not a process.
    """
    if target is not None and not isinstance(target, ProcessAction) and not callable(target):
        raise TypeError(f"target_action must be a process such as a Node, got '{target}'")

    def matches(event: Any) -> bool:
        if not isinstance(event, kind):
            return False
        action = event.action  # type: ignore[attr-defined]
        if target is None:
            return True
        return action is target if isinstance(target, ProcessAction) else bool(target(action))

    return matches


class OnProcessStart(EventHandler):
    """The handler for the start of a process."""

    def __init__(self, *, on_start: Any, target_action: Any = None, **kwargs: Any) -> None:
        super().__init__(matcher=_about(ProcessStarted, target_action), entities=on_start, **kwargs)


class OnProcessExit(EventHandler):
    """The handler for the end of a process."""

    def __init__(self, *, on_exit: Any, target_action: Any = None, **kwargs: Any) -> None:
        super().__init__(matcher=_about(ProcessExited, target_action), entities=on_exit, **kwargs)


class OnProcessIO(EventHandler):
    """The handler for output of a process. Its functions get only the event."""

    def __init__(
        self,
        *,
        target_action: Any = None,
        on_stdin: Callable[[ProcessIO], Any] | None = None,
        on_stdout: Callable[[ProcessIO], Any] | None = None,
        on_stderr: Callable[[ProcessIO], Any] | None = None,
        **kwargs: Any,
    ) -> None:
        def handle(event: ProcessIO, _context: LaunchContext) -> Any:
            function = on_stdout if event.from_stdout else on_stderr if event.from_stderr else on_stdin
            return None if function is None else function(event)

        super().__init__(matcher=_about(ProcessIO, target_action), entities=handle, **kwargs)


class OnShutdown(EventHandler):
    """The handler for the end of the launch."""

    def __init__(self, *, on_shutdown: Any, **kwargs: Any) -> None:
        super().__init__(matcher=lambda event: isinstance(event, Shutdown), entities=on_shutdown, **kwargs)
