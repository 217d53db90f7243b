"""The course's own `launch`, used if the real one is not installed.

This package reads launch files in Python, XML and YAML as Jazzy's launch does, as far as the chapter teaches them.
Anything else raises an error that names it. `docs/ros2-command.md` lists what works.
"""

from . import (
    actions,
    conditions,
    event_handlers,
    events,
    launch_description_sources,
    substitutions,
)
from .action import Action, LaunchDescriptionEntity, SomeEntitiesType, SomeEntitiesType_types_tuple
from .condition import Condition
from .event_handler import EventHandler
from .events.base import Event
from .introspection import LaunchIntrospector
from .launch_context import LaunchContext
from .launch_description import LaunchDescription
from .launch_description_sources import InvalidLaunchFileError, LaunchDescriptionSource
from .launch_service import LaunchService
from .substitution import SomeSubstitutionsType, SomeSubstitutionsType_types_tuple, Substitution


def _frontend(path: str) -> LaunchDescription:
    from .frontend.loader import load  # imported late, because most launch files are written in Python

    return load(path)


launch_description_sources.frontend = _frontend

__all__ = [
    "Action",
    "Condition",
    "Event",
    "EventHandler",
    "InvalidLaunchFileError",
    "LaunchContext",
    "LaunchDescription",
    "LaunchDescriptionEntity",
    "LaunchDescriptionSource",
    "LaunchIntrospector",
    "LaunchService",
    "SomeEntitiesType",
    "SomeEntitiesType_types_tuple",
    "SomeSubstitutionsType",
    "SomeSubstitutionsType_types_tuple",
    "Substitution",
    "actions",
    "conditions",
    "event_handlers",
    "events",
    "launch_description_sources",
    "substitutions",
]
