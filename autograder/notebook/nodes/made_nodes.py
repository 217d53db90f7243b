"""The nodes in this kernel, and the run of a cell that made each.

rclpy keeps no list of its nodes, and a node that was made and forgotten lives until Python happens to collect
it: a service of an earlier run of the cell goes on swallowing requests. So each node is noted as it comes
into being.
"""

from __future__ import annotations

import functools
import threading
import weakref
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from rclpy.exceptions import NotInitializedException
from rclpy.node import Node
from rclpy.utilities import get_default_context

from autograder.notebook.nodes.node_ends import is_destroyed

if TYPE_CHECKING:
    from collections.abc import Callable

    from rclpy.context import Context

    from autograder.notebook.cells.cell_runs import CellRun


@dataclass(frozen=True)
class NodeIdentity:
    """The identity of a node: its full name, on one context's domain.

    Attributes:
        name: The node's name with its namespace, such as ``"/robot/talker_node"``.
        context: The context to which it belongs.
    """

    name: str
    context: Context


@dataclass(frozen=True)
class MadeNode:
    """A node, and where it comes from.

    Attributes:
        node: The node.
        identity: What it is called.
        run: The run of a cell that made it; None outside a notebook.
    """

    node: Node
    identity: NodeIdentity
    run: CellRun | None


class MadeNodes:
    """Notes every node that is made from now on.

    Args:
        current_run: Tells which run of a cell is going on; None outside a notebook.
        before_making: Called with the identity of each node that is about to be made.
    """

    def __init__(
        self, current_run: Callable[[], CellRun | None], before_making: Callable[[NodeIdentity], None]
    ) -> None:
        self._current_run = current_run
        self._before_making = before_making
        self._lock = threading.Lock()
        self._made: list[tuple[weakref.ref[Node], NodeIdentity, CellRun | None]] = []

    def watch(self) -> None:
        """Begin to take note, by wrapping ``Node.__init__``: rclpy tells of new nodes nowhere else."""
        plain_init = Node.__init__

        @functools.wraps(plain_init)
        def init(node: Node, node_name: str, *args: Any, **kwargs: Any) -> None:
            __tracebackhide__ = True
            identity = _identity_to_be(node_name, kwargs)
            self._before_making(identity)
            self._note(node, identity)
            try:
                plain_init(node, node_name, *args, **kwargs)
            except NotInitializedException as error:
                error.add_note("ROS is not up in this notebook: call start_ros() before you make a node.")
                raise

        Node.__init__ = init  # type: ignore[method-assign, assignment]

    def _note(self, node: Node, identity: NodeIdentity) -> None:
        with self._lock:
            self._made = [entry for entry in self._made if entry[0]() is not None]
            self._made.append((weakref.ref(node), identity, self._current_run()))

    def alive(self) -> list[MadeNode]:
        """The nodes that are on the graph."""
        with self._lock:
            entries = [(reference(), identity, run) for reference, identity, run in self._made]
        return [
            MadeNode(node, identity, run)
            for node, identity, run in entries
            if node is not None and _has_begun(node)
        ]

    def on(self, context: Context) -> list[Node]:
        """The nodes that were made on a context and are still in memory, also those that are destroyed or failed."""
        with self._lock:
            entries = [(reference(), identity) for reference, identity, _ in self._made]
        return [node for node, identity in entries if node is not None and identity.context is context]


def _identity_to_be(node_name: str, options: dict[str, Any]) -> NodeIdentity:
    """The name that a node made with these options of ``Node.__init__`` will have."""
    namespace = str(options.get("namespace") or "").strip("/")
    return NodeIdentity(
        name="/".join(["", *filter(None, [namespace]), str(node_name)]),
        context=options.get("context") or get_default_context(),
    )


def _has_begun(node: Node) -> bool:
    """True if the node is neither destroyed nor gave up half-way through its ``__init__``."""
    try:
        return not is_destroyed(node)
    except AttributeError:
        return False
