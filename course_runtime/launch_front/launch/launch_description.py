"""A launch description: what a launch file returns."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .action import Action, LaunchDescriptionEntity

if TYPE_CHECKING:
    from collections.abc import Iterable

    from .actions.configuration import DeclareLaunchArgument
    from .launch_context import LaunchContext


class LaunchDescription(LaunchDescriptionEntity):
    """Entities, in the order in which they happen."""

    def __init__(
        self,
        initial_entities: Iterable[LaunchDescriptionEntity] | None = None,
        *,
        deprecated_reason: str | None = None,
    ) -> None:
        self.entities: list[LaunchDescriptionEntity] = []
        self.deprecated_reason = deprecated_reason
        for entity in initial_entities or ():
            self.add_entity(entity)

    def add_entity(self, entity: LaunchDescriptionEntity) -> None:
        """Add an entity at the end.

        Raises:
            TypeError: The object is not an entity.
        """
        if not isinstance(entity, LaunchDescriptionEntity):
            raise TypeError(
                f"a LaunchDescription holds actions such as Node(…), got {entity!r} ({type(entity).__name__})"
            )
        self.entities.append(entity)

    add_action = add_entity

    def sub_entities(self) -> Iterable[LaunchDescriptionEntity]:
        """Return the entities."""
        return self.entities

    def visit(self, context: LaunchContext) -> Iterable[LaunchDescriptionEntity]:
        """Return the entities, and warn if the launch file is deprecated."""
        if self.deprecated_reason is not None:
            context.screen.log(
                "WARNING",
                "launch",
                f"launch file [{context.current_launch_file}] is deprecated: {self.deprecated_reason}",
            )
        return self.entities

    def get_launch_arguments(self) -> list[DeclareLaunchArgument]:
        """Return the declared arguments, including those of included files; each name once."""
        return [argument for argument, _ in declared_arguments(self)]


def declared_arguments(
    description: LaunchDescription, *, closed: tuple[type[Action], ...] = ()
) -> list[tuple[DeclareLaunchArgument, bool]]:
    """Return each declared argument of a launch description, with True if its declaration depends on a condition.

    Args:
        description: The launch description to search.
        closed: The kinds of actions whose content is not searched.
    """
    from .actions.configuration import DeclareLaunchArgument

    found: dict[str, tuple[DeclareLaunchArgument, bool]] = {}

    def search(entities: Iterable[LaunchDescriptionEntity], *, conditional: bool) -> None:
        for entity in entities:
            if isinstance(entity, closed):
                continue
            under = conditional or (isinstance(entity, Action) and entity.condition is not None)
            if isinstance(entity, DeclareLaunchArgument):
                found.setdefault(entity.name, (entity, under))
            search(entity.sub_entities(), conditional=conditional)
            search(entity.conditional_sub_entities(), conditional=True)

    search(description.entities, conditional=False)
    return list(found.values())
