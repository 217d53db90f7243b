"""A tag of an XML file or an entry of a YAML file, in a common form."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence


class FrontendError(Exception):
    """An XML or YAML launch file is not valid."""


@dataclass
class Entity:
    """A tag, its attributes and its content.

    Each access is recorded, so that a misspelled attribute is not silently ignored.

    Attributes:
        tag: The name of the tag, such as `node`.
        attributes: The attributes: text in XML; text, numbers, truth values and lists in YAML.
        children: The entities inside, in order.
    """

    tag: str
    attributes: Mapping[str, Any]
    children: Sequence[Entity] = ()
    _read: set[str] = field(default_factory=set)
    _read_children: set[str] = field(default_factory=set)

    def get(self, name: str) -> Any | None:
        """Return an attribute; None if it does not exist."""
        self._read.add(name)
        value = self.attributes.get(name)
        separator = self.attributes.get(f"{name}-sep")
        if separator is not None and isinstance(value, str):
            self._read.add(f"{name}-sep")
            return value.split(separator)
        return value

    def text(self, name: str) -> str | None:
        """Return an attribute as text; None if it does not exist."""
        value = self.get(name)
        if value is None or isinstance(value, str):
            return value
        # A number or a truth value of YAML becomes the text that XML would contain.
        return json.dumps(value)

    def need(self, name: str) -> str:
        """Return an attribute as text.

        Raises:
            FrontendError: The attribute does not exist.
        """
        value = self.text(name)
        if value is None:
            raise FrontendError(f"Attribute '{name}' not found in Entity '{self.tag}'")
        return value

    def inside(self, tag: str) -> list[Entity]:
        """Return the entities inside that have this name."""
        self._read_children.add(tag)
        return [child for child in self.children if child.tag == tag]

    def all_inside(self) -> Sequence[Entity]:
        """Return all entities inside."""
        self._read_children.update(child.tag for child in self.children)
        return self.children

    def check_all_read(self) -> None:
        """Check that every attribute and tag was read.

        Raises:
            FrontendError: An attribute or tag was not read.
        """
        attributes = sorted(set(self.attributes) - self._read)
        if attributes:
            raise FrontendError(f"Unexpected attribute(s) found in `{self.tag}`: {', '.join(attributes)}")
        tags = sorted({child.tag for child in self.children} - self._read_children)
        if tags:
            raise FrontendError(f"Unexpected nested tag(s) found in `{self.tag}`: {', '.join(tags)}")


def from_xml(text: str) -> Entity:
    """Read XML.

    Raises:
        FrontendError: The text is not well-formed XML.
    """
    import xml.etree.ElementTree as ElementTree

    def convert(element: ElementTree.Element) -> Entity:
        return Entity(element.tag, dict(element.attrib), [convert(child) for child in element])

    try:
        return convert(ElementTree.fromstring(text))
    except ElementTree.ParseError as error:
        raise FrontendError(f"the XML is not well-formed: {error}") from error


def from_yaml(text: str) -> Entity:
    """Read YAML.

    Raises:
        FrontendError: The text is not YAML, or does not have the format of a launch file.
    """
    import yaml

    try:
        tree = yaml.safe_load(text)
    except yaml.YAMLError as error:
        raise FrontendError(f"the YAML can not be read: {error}") from error
    if not isinstance(tree, dict) or len(tree) != 1:
        raise FrontendError("Expected only one root")
    tag, content = next(iter(tree.items()))
    return _from_content(tag, content)


def _from_content(tag: str, content: Any) -> Entity:
    if isinstance(content, list):
        return Entity(tag, {}, [_from_item(tag, item) for item in content])
    if content is None:
        content = {}
    if not isinstance(content, dict):
        raise FrontendError(f"`{tag}` must be a dictionary or a list, got {content!r}")
    attributes: dict[str, Any] = {}
    children: list[Entity] = []
    for name, value in content.items():
        if name == "children":
            children += [_from_item(tag, item) for item in value]
        elif isinstance(value, list) and value and all(isinstance(item, dict) for item in value):
            # A list, as for `param:` of a node, becomes several entities with that name.
            children += [_from_content(name, item) for item in value]
        else:
            attributes[str(name)] = value
    return Entity(tag, attributes, children)


def _from_item(tag: str, item: Any) -> Entity:
    if not isinstance(item, dict) or len(item) != 1:
        raise FrontendError(
            f"Subentities of `{tag}` must be a dictionary with only one key, which is the entity type"
        )
    name, content = next(iter(item.items()))
    return _from_content(name, content)
