"""The parts of a launch description."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from .unsupported import refuse_arguments

if TYPE_CHECKING:
    from .condition import Condition
    from .launch_context import LaunchContext


class LaunchDescriptionEntity:
    """An entity of a launch description. Visiting it carries it out."""

    def visit(self, context: LaunchContext) -> Iterable[LaunchDescriptionEntity] | None:
        """Carry the entity out, and return the entities to visit next."""
        del context
        return None

    def sub_entities(self) -> Iterable[LaunchDescriptionEntity]:
        """Return the entities inside this one, as far as they are known before the launch."""
        return ()

    def conditional_sub_entities(self) -> Iterable[LaunchDescriptionEntity]:
        """Return the entities inside this one that are visited only at an event."""
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
        """Return the text of the action for `--print`."""
        return f"Action('{self}')"

    def visit(self, context: LaunchContext) -> Iterable[LaunchDescriptionEntity] | None:
        """Execute the action if its condition holds."""
        if self.condition is None or self.condition.evaluate(context):
            return self.execute(context)
        return None

    def execute(self, context: LaunchContext) -> Iterable[LaunchDescriptionEntity] | None:
        """Execute the action. Each kind of action defines this."""
        del context
        return None


class ProcessAction(Action):
    """The base class of actions that start a process, to which events of processes refer."""


def as_entities(value: Any) -> list[LaunchDescriptionEntity]:
    """Return the result of a handler or a function as a list of entities.

    Raises:
        RuntimeError: The result contains something else.
    """
    if value is None:
        return []
    items = list(value) if isinstance(value, Iterable) else [value]
    for item in items:
        if item is not None and not isinstance(item, LaunchDescriptionEntity):
            raise RuntimeError(f"expected a LaunchDescriptionEntity, got '{item}'")
    return [item for item in items if item is not None]
