"""From the text of an XML or YAML launch file to a launch description."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..launch_description import LaunchDescription
from .entity import Entity, FrontendError, from_xml, from_yaml
from .tags import parse_entity

if TYPE_CHECKING:
    from collections.abc import Callable


def load(path: str) -> LaunchDescription:
    """Read a launch file.

    Raises:
        FrontendError: it is not as it should be.
    """
    # The tags of nodes are launch_ros's.
    import launch_ros.tags  # noqa: F401

    with open(path, encoding="utf-8") as file:  # noqa: PTH123 (pathlib costs start-up time)
        text = file.read()
    root = _reader(path, text)(text)
    if root.tag != "launch":
        raise FrontendError("Expected 'launch' as root tag")
    deprecated = root.text("deprecated")
    entities = [parse_entity(child) for child in root.all_inside()]
    root.check_all_read()
    return LaunchDescription(entities, deprecated_reason=deprecated)


def _reader(path: str, text: str) -> Callable[[str], Entity]:
    """Return the function that reads the format, by the end of the file's name or else by its first sign."""
    if path.endswith((".yaml", ".yml")):
        return from_yaml
    if path.endswith(".xml"):
        return from_xml
    return from_xml if text.lstrip().startswith("<") else from_yaml
