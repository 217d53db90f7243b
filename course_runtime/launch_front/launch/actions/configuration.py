"""Actions for launch arguments: declare, set and unset them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ..action import Action
from ..substitution import SomeSubstitutionsType, normalize, perform

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ..launch_context import LaunchContext


class DeclareLaunchArgument(Action):
    """An argument of the launch file, which `name:=value` sets."""

    def __init__(
        self,
        name: str,
        *,
        default_value: SomeSubstitutionsType | None = None,
        description: str | None = None,
        choices: Sequence[str] | None = None,
        **kwargs: Any,
    ) -> None:
        super().__init__(**kwargs)
        if choices is not None and not choices:
            raise RuntimeError("Provided choices arg is empty. Use None to ignore the choice list.")
        if choices is not None and isinstance(default_value, str) and default_value not in choices:
            raise RuntimeError(
                f'Provided default_value "{default_value}" is not in provided choices "{choices}".'
            )
        self.name = name
        self.default_value = None if default_value is None else normalize(default_value)
        self.choices = choices
        self.description = self._described(description)

    def _described(self, description: str | None) -> str:
        if self.choices is None:
            return "no description given" if description is None else description
        if description is None:
            return f"One of: {self.choices}"
        return f"{description.removesuffix('.')}. Valid choices are: {self.choices}"

    def execute(self, context: LaunchContext) -> None:
        """Set the argument to the given value, or to its default."""
        values = context.launch_configurations
        if self.name not in values:
            if self.default_value is None:
                context.screen.log(
                    "ERROR",
                    "launch.actions.declare_launch_argument",
                    f'Required launch argument "{self.name}" (description: "{self.description}") '
                    "was not provided",
                )
                raise RuntimeError(f'Required launch argument "{self.name}" was not provided.')
            values[self.name] = perform(context, self.default_value)
        if self.choices is not None and values[self.name] not in self.choices:
            raise RuntimeError(
                f'Argument "{self.name}" provided value "{values[self.name]}" is not valid. '
                f"Valid options are: {self.choices}"
            )


class SetLaunchConfiguration(Action):
    """Give a launch argument a value."""

    def __init__(self, name: SomeSubstitutionsType, value: SomeSubstitutionsType, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self._name, self._value = normalize(name), normalize(value)

    def evaluated(self, context: LaunchContext) -> tuple[str, str]:
        """Return the name and the value."""
        return perform(context, self._name), perform(context, self._value)

    def execute(self, context: LaunchContext) -> None:
        """Set the argument."""
        name, value = self.evaluated(context)
        context.launch_configurations[name] = value


class UnsetLaunchConfiguration(Action):
    """Forget the value of a launch argument."""

    def __init__(self, name: SomeSubstitutionsType, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self._name = normalize(name)

    def execute(self, context: LaunchContext) -> None:
        """Remove the argument."""
        context.launch_configurations.pop(perform(context, self._name), None)


class PushLaunchConfigurations(Action):
    """Begins a scope of launch arguments."""

    def execute(self, context: LaunchContext) -> None:
        """Begin the scope."""
        context.push_scope()


class PopLaunchConfigurations(Action):
    """Ends the scope that was begun last."""

    def execute(self, context: LaunchContext) -> None:
        """End the scope."""
        context.pop_scope()
