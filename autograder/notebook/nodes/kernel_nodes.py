"""The nodes in this kernel: noted as each comes into being, and ended so that nothing of it stays on the graph.

rclpy keeps no list of its nodes, and a node that was made and forgotten lives until Python happens to collect
it: a service of an earlier run of the cell goes on swallowing requests. So each node is noted as it comes
into being, with the run of a cell that made it.
"""

from __future__ import annotations

import functools
import threading
import warnings
import weakref
from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from rclpy.exceptions import InvalidHandle, NotInitializedException
from rclpy.node import Node
from rclpy.task import Future
from rclpy.utilities import get_default_context

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from rclpy.context import Context

    from autograder.notebook.cells.cell_runs import CellRun

_STOPPED = "was stopped while this call was waiting for its answer"


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


class NodeEndedError(RuntimeError):
    """The node has ended: it was destroyed, or ROS was shut down under it."""


def destroy_node(node: Node) -> None:
    """Destroy a node with all that hangs on it; harmless for one that is destroyed already.

    ``Node.destroy_node`` leaves action servers and clients alone, and as long as one of them lives the node
    stays on the graph: goals would still be sent to it. Whoever waits for an answer to a call through this
    node is woken with a ``NodeEndedError``, as that answer can no longer come.
    """
    release_waiting_calls(node)
    for waitable in _parts(node, "waitables"):
        if hasattr(waitable, "destroy"):
            with suppress(InvalidHandle):
                waitable.destroy()
    # A node whose __init__ failed half-way lacks some of its parts.
    with suppress(InvalidHandle, AttributeError):
        node.destroy_node()


def node_label(node: Any) -> str:
    """The node's name; its class where the node cannot be asked any more."""
    if node is None:
        return "a node"
    try:
        return str(node.get_name())
    except (InvalidHandle, AttributeError):  # destroyed, or its super().__init__() was never called
        return type(node).__name__


def is_destroyed(node: Node) -> bool:
    """True if the node was destroyed."""
    try:
        with node.handle:
            return False
    except InvalidHandle:
        return True


def release_waiting_calls(node: Node) -> None:
    """Wake everybody who waits for a service's or an action's answer through this node."""
    error = NodeEndedError(f"{node_label(node)} {_STOPPED}")
    for future in list(_pending_answers(node)):
        if not future.done():
            with warnings.catch_warnings():
                # A callback that asks for the answer gets this error. rclpy would warn of it, though all is as meant.
                warnings.filterwarnings("ignore", f".* {_STOPPED}", UserWarning)
                future.set_exception(error)
            # Nobody needs to look at it: unfetched exceptions are written to stderr when the future is
            # collected.
            future.exception()


def _pending_answers(node: Node) -> Iterator[Future]:
    # rclpy keeps what it waits for in dicts by sequence number (rclpy/client.py, rclpy/action/client.py).
    for client in (*_parts(node, "clients"), *_parts(node, "waitables")):
        for name, requests in vars(client).items():
            if name.startswith("_pending_") and isinstance(requests, dict):
                yield from (future for future in list(requests.values()) if isinstance(future, Future))


def _parts(node: Node, kind: str) -> list[Any]:
    """The node's ``clients`` or ``waitables``; none where its ``__init__`` did not get that far."""
    try:
        return list(getattr(node, kind))
    except AttributeError:
        return []
