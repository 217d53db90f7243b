"""Environment variables of the processes that are started afterwards."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

from ..action import Action
from ..substitution import SomeSubstitutionsType, normalize, perform
from ..typed import flag

if TYPE_CHECKING:
    from ..launch_context import LaunchContext


class SetEnvironmentVariable(Action):
    """Set an environment variable."""

    def __init__(self, name: SomeSubstitutionsType, value: SomeSubstitutionsType, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self._name, self._value = normalize(name), normalize(value)

    def execute(self, context: LaunchContext) -> None:
        """Set the variable."""
        context.environment[perform(context, self._name)] = perform(context, self._value)


class UnsetEnvironmentVariable(Action):
    """Remove an environment variable."""

    def __init__(self, name: SomeSubstitutionsType, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self._name = normalize(name)

    def execute(self, context: LaunchContext) -> None:
        """Remove the variable."""
        context.environment.pop(perform(context, self._name), None)


class AppendEnvironmentVariable(Action):
    """Add to an environment variable such as PATH."""

    def __init__(
        self,
        name: SomeSubstitutionsType,
        value: SomeSubstitutionsType,
        prepend: bool | SomeSubstitutionsType = False,
        separator: SomeSubstitutionsType = os.pathsep,
        **kwargs: Any,
    ) -> None:
        super().__init__(**kwargs)
        self._name, self._value, self._separator = normalize(name), normalize(value), normalize(separator)
        self._prepend = prepend

    def execute(self, context: LaunchContext) -> None:
        """Append to the variable; set it if it does not exist."""
        name, value = perform(context, self._name), perform(context, self._value)
        parts = [context.environment[name], value] if name in context.environment else [value]
        if flag(context, self._prepend):
            parts.reverse()
        context.environment[name] = perform(context, self._separator).join(parts)
