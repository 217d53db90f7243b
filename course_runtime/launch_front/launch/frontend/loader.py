"""Turns the text of an XML or YAML launch file into a launch description."""

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
        FrontendError: The file is not valid.
    """
    # This import defines the tags of nodes, which belong to launch_ros.
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
    """Return the reader of a file's format, decided by the file's extension or else by the text's first character."""
    if path.endswith((".yaml", ".yml")):
        return from_yaml
    if path.endswith(".xml"):
        return from_xml
    return from_xml if text.lstrip().startswith("<") else from_yaml
