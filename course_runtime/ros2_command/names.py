"""Names on the ROS graph: hidden ones, and full names of nodes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable


def is_hidden(name: str) -> bool:
    """Return True if a part of the name of a topic, service or action begins with an underscore."""
    return any(part.startswith("_") for part in name.split("/"))


@dataclass(frozen=True, order=True)
class NodeName:
    """A node of the graph."""

    name: str
    namespace: str

    @property
    def full(self) -> str:
        """The name with its namespace, such as `/robot1/talker`."""
        return f"{self.namespace.rstrip('/')}/{self.name}"

    @property
    def hidden(self) -> bool:
        """True if lists leave the node out, as the node of this command."""
        return not self.name or self.name.startswith("_")


def show(found: Iterable[tuple[str, list[str]]], *, count: bool, types: bool = False) -> None:
    """Print names, with their types or only their number if requested."""
    if count:
        print(len(list(found)))
        return
    for name, its_types in found:
        print(f"{name} [{', '.join(its_types)}]" if types else name)


def absolute(node_name: str) -> str:
    """Return the name of a node, with a slash at its beginning."""
    return node_name if node_name.startswith("/") else f"/{node_name}"
