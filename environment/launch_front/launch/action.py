"""The parts of a launch description."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from .unsupported import refuse_arguments

if TYPE_CHECKING:
    from .condition import Condition
    from .launch_context import LaunchContext


class LaunchDescriptionEntity:
    """An entity of a launch description. Visiting it makes it happen."""

    def visit(self, context: LaunchContext) -> Iterable[LaunchDescriptionEntity] | None:
        """Do what it stands for, and return the entities to visit next."""
        del context
        return None

    def sub_entities(self) -> Iterable[LaunchDescriptionEntity]:
        """Return the entities inside, as far as they are known beforehand."""
        return ()

    def conditional_sub_entities(self) -> Iterable[LaunchDescriptionEntity]:
        """Return the entities inside that are visited only if something happens."""
        return ()


# The values that handlers and functions may return: nothing, one entity, or several.
SomeEntitiesType = LaunchDescriptionEntity | Iterable[LaunchDescriptionEntity]
SomeEntitiesType_types_tuple = (LaunchDescriptionEntity, Iterable)


class Action(LaunchDescriptionEntity):
    """An entity that does something, if its condition holds."""

    def __init__(self, *, condition: Condition | None = None, **unknown: Any) -> None:
        refuse_arguments(type(self).__name__, unknown)
        self.condition = condition

    def describe(self) -> str:
        """Return the line for `--print`."""
        return f"Action('{self}')"

    def visit(self, context: LaunchContext) -> Iterable[LaunchDescriptionEntity] | None:
        """Execute the action if its condition holds."""
        if self.condition is None or self.condition.evaluate(context):
            return self.execute(context)
        return None

    def execute(self, context: LaunchContext) -> Iterable[LaunchDescriptionEntity] | None:
        """Do it. Each action has its own."""
        del context
        return None


class ProcessAction(Action):
    """The base of the actions that start a process: what an event of a process is about."""


def as_entities(value: Any) -> list[LaunchDescriptionEntity]:
    """Return what a handler or a function gave as a list of entities.

    Raises:
        RuntimeError: there is something else among it.
    """
    if value is None:
        return []
    items = list(value) if isinstance(value, Iterable) else [value]
    for item in items:
        if item is not None and not isinstance(item, LaunchDescriptionEntity):
            raise RuntimeError(f"expected a LaunchDescriptionEntity, got '{item}'")
    return [item for item in items if item is not None]
