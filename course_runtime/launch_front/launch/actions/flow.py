"""Actions that group or delay other actions, print a message, or call a function."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ..action import Action, LaunchDescriptionEntity, as_entities
from ..substitution import SomeSubstitutionsType, describe, normalize, perform
from ..typed import flag, number
from .configuration import PopLaunchConfigurations, PushLaunchConfigurations, SetLaunchConfiguration

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

    from ..launch_context import LaunchContext


class LogInfo(Action):
    """Prints a message on the screen."""

    def __init__(self, *, msg: SomeSubstitutionsType, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self.msg = normalize(msg)

    def describe(self) -> str:
        """Return the text of the action for `--print`."""
        return f"LogInfo({describe(self.msg)})"

    def execute(self, context: LaunchContext) -> None:
        """Print the message."""
        context.screen.log("INFO", "launch.user", perform(context, self.msg))


class GroupAction(Action):
    """A group of actions. Settings made in it end with the group, unless `scoped` is False."""

    def __init__(
        self,
        actions: Iterable[LaunchDescriptionEntity],
        *,
        scoped: bool = True,
        forwarding: bool = True,
        launch_configurations: Mapping[SomeSubstitutionsType, SomeSubstitutionsType] | None = None,
        **kwargs: Any,
    ) -> None:
        super().__init__(**kwargs)
        self._actions = list(actions)
        self._scoped, self._forwarding = scoped, forwarding
        self._sets = [
            SetLaunchConfiguration(name, value) for name, value in (launch_configurations or {}).items()
        ]

    def sub_entities(self) -> Iterable[LaunchDescriptionEntity]:
        """Return the actions of the group."""
        return self._actions

    def execute(self, context: LaunchContext) -> Iterable[LaunchDescriptionEntity]:  # noqa: ARG002
        """Return the actions, inside a separate scope."""
        if not self._scoped:
            return [*self._sets, *self._actions]
        clean = [] if self._forwarding else [OpaqueFunction(function=_forget_outside, args=[self._sets])]
        return [
            PushLaunchConfigurations(),
            *(clean or self._sets),
            *self._actions,
            PopLaunchConfigurations(),
        ]


def _forget_outside(context: LaunchContext, sets: Iterable[SetLaunchConfiguration]) -> None:
    """Remove all launch arguments set outside, except those that the group names."""
    kept = dict(action.evaluated(context) for action in sets)
    context.launch_configurations.clear()
    context.launch_configurations.update(kept)
    context.remappings, context.parameters = [], []


class TimerAction(Action):
    """Actions that happen after a number of seconds."""

    def __init__(
        self,
        *,
        period: float | SomeSubstitutionsType,
        actions: Iterable[LaunchDescriptionEntity],
        cancel_on_shutdown: bool | SomeSubstitutionsType = True,
        **kwargs: Any,
    ) -> None:
        super().__init__(**kwargs)
        self._period, self._actions = period, list(actions)
        self._cancel_on_shutdown = cancel_on_shutdown
        self._timer: Any = None

    def describe(self) -> str:
        """Return the text of the action for `--print`."""
        return f"TimerAction(period={self._period}, actions=<actions>)"

    def conditional_sub_entities(self) -> Iterable[LaunchDescriptionEntity]:
        """Return the actions."""
        return self._actions

    def cancel(self) -> None:
        """Cancel the actions if they have not happened yet."""
        if self._timer is not None:
            self._timer.cancel()

    def execute(self, context: LaunchContext) -> None:
        """Start the timer."""
        if context.timers is None:
            raise RuntimeError("a TimerAction needs a running LaunchService")
        launch_file = context.current_launch_file

        def fire() -> None:
            context.current_launch_file = launch_file
            context.to_visit.extend(self._actions)

        self._timer = context.timers.after(
            number(context, self._period),
            fire,
            cancel_on_shutdown=flag(context, self._cancel_on_shutdown),
        )


class OpaqueFunction(Action):
    """A function of the launch file, called with the context. It may return further actions."""

    def __init__(
        self,
        *,
        function: Callable[..., Any],
        args: Iterable[Any] | None = None,
        kwargs: Mapping[str, Any] | None = None,
        **left: Any,
    ) -> None:
        super().__init__(**left)
        if not callable(function):
            raise TypeError(f"OpaqueFunction expected a callable for 'function', got '{type(function)}'")
        self._function, self._args, self._kwargs = function, list(args or ()), dict(kwargs or {})

    def execute(self, context: LaunchContext) -> Iterable[LaunchDescriptionEntity]:
        """Call the function."""
        return as_entities(self._function(context, *self._args, **self._kwargs))
