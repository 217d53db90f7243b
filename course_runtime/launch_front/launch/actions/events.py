"""Actions that emit events, and actions that say what to do at an event."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ..action import Action
from ..events import Shutdown as ShutdownEvent
from ..events.base import Event
from ..events.process import ProcessExited

if TYPE_CHECKING:
    from collections.abc import Iterable

    from ..action import LaunchDescriptionEntity
    from ..event_handler import EventHandler
    from ..launch_context import LaunchContext


class EmitEvent(Action):
    """Emits an event."""

    def __init__(self, *, event: Event, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        if not isinstance(event, Event):
            raise RuntimeError(f"EmitEvent() expected an event instance, got '{event}'.")
        self.event = event

    def describe(self) -> str:
        """Return the text of the action for `--print`."""
        return f"EmitEvent(event='{self.event.name}')"

    def execute(self, context: LaunchContext) -> None:
        """Emit the event."""
        context.emit_event_sync(self.event)


class Shutdown(EmitEvent):
    """End the launch."""

    def __init__(self, *, reason: str = "reason not given", **kwargs: Any) -> None:
        super().__init__(event=ShutdownEvent(reason=reason), **kwargs)

    def execute(self, context: LaunchContext) -> None:
        """End the launch. Name the process whose end was the reason."""
        if isinstance(context.event, ProcessExited):
            name = context.event.process_name
            context.screen.log(
                "INFO", "launch", f"process[{name}] was required: shutting down launched system"
            )
        super().execute(context)


class RegisterEventHandler(Action):
    """Adds a handler for an event."""

    def __init__(self, event_handler: EventHandler, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self.event_handler = event_handler

    def describe(self) -> str:
        """Return the text of the action for `--print`."""
        return f"RegisterEventHandler('{type(self.event_handler).__name__}'):"

    def conditional_sub_entities(self) -> Iterable[LaunchDescriptionEntity]:
        """Return the entities that are visited at the event."""
        return self.event_handler.entities

    def execute(self, context: LaunchContext) -> None:
        """Add the handler."""
        context.register_event_handler(self.event_handler)


class UnregisterEventHandler(RegisterEventHandler):
    """Removes an event handler."""

    def execute(self, context: LaunchContext) -> None:
        """Remove the handler."""
        context.handlers.remove(self.event_handler)
