"""Shows a launch description as a tree of text, for `--print`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .action import Action

if TYPE_CHECKING:
    from collections.abc import Iterable

    from .action import LaunchDescriptionEntity
    from .launch_description import LaunchDescription


class LaunchIntrospector:
    """Formats launch descriptions."""

    def format_launch_description(self, launch_description: LaunchDescription) -> str:
        """Return a line for the description and one for each entity, those of event handlers below them."""
        return "\n".join([str(launch_description), *_tree(launch_description.entities)])


def _tree(entities: Iterable[LaunchDescriptionEntity]) -> list[str]:
    lines: list[str] = []
    items = list(entities)
    for position, entity in enumerate(items):
        last = position == len(items) - 1
        text = entity.describe() if isinstance(entity, Action) else f"Unknown entity('{entity}')"
        lines.append(f"{'└' if last else '├'}── {text}")
        inner = entity.conditional_sub_entities() if text.startswith("RegisterEventHandler") else ()
        lines += [f"{' ' if last else '│'}   {line}" for line in _tree(inner)]
    return lines
