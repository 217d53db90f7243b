"""The conditions that a launch file can use."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .condition import Condition
from .substitution import SomeSubstitutionsType, normalize, perform
from .typed import InvalidConditionExpressionError, truth

if TYPE_CHECKING:
    from .launch_context import LaunchContext

__all__ = [
    "IfCondition",
    "InvalidConditionExpressionError",
    "LaunchConfigurationEquals",
    "LaunchConfigurationNotEquals",
    "UnlessCondition",
]


class IfCondition(Condition):
    """A condition that holds if an expression is true or 1."""

    def __init__(self, predicate_expression: SomeSubstitutionsType) -> None:
        super().__init__()
        self._expression = normalize(predicate_expression)

    def evaluate(self, context: LaunchContext) -> bool:
        """Return True if the condition holds now."""
        return truth(perform(context, self._expression))


class UnlessCondition(IfCondition):
    """A condition that holds if an expression is false or 0."""

    def evaluate(self, context: LaunchContext) -> bool:
        """Return True if the condition holds now."""
        return not super().evaluate(context)


class LaunchConfigurationEquals(Condition):
    """A condition that holds if a launch argument has the given value."""

    def __init__(self, launch_configuration_name: str, expected_value: SomeSubstitutionsType | None) -> None:
        super().__init__()
        self._name = launch_configuration_name
        self._expected = None if expected_value is None else normalize(expected_value)

    def evaluate(self, context: LaunchContext) -> bool:
        """Return True if the condition holds now."""
        expected = None if self._expected is None else perform(context, self._expected)
        return context.launch_configurations.get(self._name) == expected


class LaunchConfigurationNotEquals(LaunchConfigurationEquals):
    """A condition that holds if a launch argument does not have the given value."""

    def evaluate(self, context: LaunchContext) -> bool:
        """Return True if the condition holds now."""
        return not super().evaluate(context)
