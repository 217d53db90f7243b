"""The state of a running launch: arguments, environment, handlers, and the entities to visit."""

from __future__ import annotations

import os
from collections import deque
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from .screen import Screen

if TYPE_CHECKING:
    from collections.abc import Sequence

    from .action import LaunchDescriptionEntity
    from .event_handler import EventHandler
    from .events import Event
    from .running_process import RunningProcess
    from .timers import Timers


@dataclass
class _Scope:
    """The settings that are restored at the end of a scoped group."""

    configurations: dict[str, str]
    environment: dict[str, str]
    remappings: list[tuple[str, str]]
    parameters: list[tuple[str, Any]]


@dataclass
class LaunchContext:
    """The state of a launch.

    Attributes:
        argv: The arguments of the launch, such as `name:=value`.
        launch_configurations: The values of launch arguments by name, and values that launch itself stores there.
        environment: The environment variables for processes that are started.
        current_launch_file: The path of the launch file that is being read.
        remappings: The remapping rules for all nodes of the current scope (SetRemap).
        parameters: The parameters for all nodes of the current scope (SetParameter).
        is_shutdown: True if the launch is ending. Nothing new is started then.
    """

    argv: Sequence[str] = ()
    launch_configurations: dict[str, str] = field(default_factory=dict)
    environment: dict[str, str] = field(default_factory=lambda: dict(os.environ))
    current_launch_file: str | None = None
    remappings: list[tuple[str, str]] = field(default_factory=list)
    parameters: list[tuple[str, Any]] = field(default_factory=list)
    is_shutdown: bool = False
    screen: Screen = field(default_factory=Screen)
    event: Event | None = None
    # The entities that the service has to visit, in order.
    to_visit: deque[LaunchDescriptionEntity] = field(default_factory=deque)
    events: deque[Event] = field(default_factory=deque)
    to_start: deque[RunningProcess] = field(default_factory=deque)
    handlers: list[EventHandler] = field(default_factory=list)
    timers: Timers | None = None
    process_count: int = 0
    temporary_files: list[str] = field(default_factory=list)
    node_names: dict[str, int] = field(default_factory=dict)
    _scopes: list[_Scope] = field(default_factory=list)

    def push_scope(self) -> None:
        """Begin a scope. Everything that is set from now on is reset at its end."""
        self._scopes.append(
            _Scope(
                dict(self.launch_configurations),
                dict(self.environment),
                list(self.remappings),
                list(self.parameters),
            )
        )

    def pop_scope(self) -> None:
        """End a scope."""
        scope = self._scopes.pop()
        # The dictionaries are changed and not replaced, because a function of a launch file may have a reference to
        # them.
        self.launch_configurations.clear()
        self.launch_configurations.update(scope.configurations)
        self.environment.clear()
        self.environment.update(scope.environment)
        self.remappings, self.parameters = scope.remappings, scope.parameters

    def emit_event_sync(self, event: Event) -> None:
        """Put an event into the queue of events to handle."""
        self.events.append(event)

    def register_event_handler(self, handler: EventHandler) -> None:
        """Add a handler. The handler that was added last is asked first."""
        self.handlers.insert(0, handler)

    def perform_substitution(self, substitution: Any) -> str:
        """Return the value of a substitution."""
        from .substitution import normalize, perform

        return perform(self, normalize(substitution))
