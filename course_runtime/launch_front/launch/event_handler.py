"""The base of all event handlers."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from .action import as_entities
from .unsupported import refuse_arguments

if TYPE_CHECKING:
    from collections.abc import Callable

    from .action import LaunchDescriptionEntity, SomeEntitiesType
    from .events.base import Event
    from .launch_context import LaunchContext


class EventHandler:
    """Decides what to do at an event."""

    def __init__(
        self,
        *,
        matcher: Callable[[Any], bool],
        entities: SomeEntitiesType | Callable[[Any, LaunchContext], SomeEntitiesType | None] | None = None,
        handle_once: bool = False,
        **unknown: Any,
    ) -> None:
        refuse_arguments(type(self).__name__, unknown)
        self._matcher = matcher
        self._function = entities if callable(entities) else None
        self.entities = [] if callable(entities) else as_entities(entities)
        self.handle_once = handle_once

    def matches(self, event: Event) -> bool:
        """Return True if this handler applies to the event."""
        return self._matcher(event)

    def handle(self, event: Event, context: LaunchContext) -> list[LaunchDescriptionEntity]:
        """Return the entities to visit at the event."""
        if self.handle_once:
            context.handlers.remove(self)
        return self.entities if self._function is None else as_entities(self._function(event, context))
