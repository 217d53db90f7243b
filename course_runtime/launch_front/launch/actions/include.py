"""The action that includes another launch file."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

from ..action import Action, LaunchDescriptionEntity
from ..launch_description import declared_arguments
from ..launch_description_sources import AnyLaunchDescriptionSource, LaunchDescriptionSource
from ..substitution import SomeSubstitutionsType, normalize, perform
from .configuration import SetLaunchConfiguration
from .flow import OpaqueFunction

if TYPE_CHECKING:
    from collections.abc import Iterable

    from ..launch_context import LaunchContext
    from ..launch_description import LaunchDescription
    from .configuration import DeclareLaunchArgument


class IncludeLaunchDescription(Action):
    """Everything that another launch file describes, with arguments for that file."""

    def __init__(
        self,
        launch_description_source: LaunchDescriptionSource | SomeSubstitutionsType,
        *,
        launch_arguments: Iterable[tuple[SomeSubstitutionsType, SomeSubstitutionsType]] | None = None,
        **kwargs: Any,
    ) -> None:
        super().__init__(**kwargs)
        if not isinstance(launch_description_source, LaunchDescriptionSource):
            launch_description_source = AnyLaunchDescriptionSource(launch_description_source)
        self.launch_description_source = launch_description_source
        self.launch_arguments = [
            (normalize(name), normalize(value)) for name, value in launch_arguments or ()
        ]

    def sub_entities(self) -> Iterable[LaunchDescriptionEntity]:
        """Return the launch description, if its path is known without running the launch."""
        found = self.launch_description_source.try_get_launch_description_without_context()
        return [] if found is None else [found]

    def execute(self, context: LaunchContext) -> Iterable[LaunchDescriptionEntity]:
        """Read the file, and return its launch description.

        Raises:
            RuntimeError: An argument without a default value is missing.
        """
        source = self.launch_description_source
        outside = context.current_launch_file
        description = source.get_launch_description(context)
        given = [perform(context, name) for name, _ in self.launch_arguments]
        for argument in _required_arguments(description):
            if argument.name not in given and argument.name not in context.launch_configurations:
                raise RuntimeError(
                    f"Included launch description missing required argument '{argument.name}' "
                    f"(description: '{argument.description}'), given: [{', '.join(given)}]"
                )

        def inside(path: str | None) -> OpaqueFunction:
            return OpaqueFunction(function=lambda c: setattr(c, "current_launch_file", path))

        return [
            *(SetLaunchConfiguration(name, value) for name, value in self.launch_arguments),
            inside(os.path.abspath(source.location)),  # noqa: PTH100 (does not follow links)
            description,
            inside(outside),
        ]


def _required_arguments(description: LaunchDescription) -> list[DeclareLaunchArgument]:
    """Return the arguments without a default value that this description itself always declares.

    An included file, at any depth, checks its own arguments when it is included.
    """
    return [
        argument
        for argument, conditional in declared_arguments(description, closed=(IncludeLaunchDescription,))
        if not conditional and argument.default_value is None
    ]
