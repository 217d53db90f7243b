"""Ending a node so that nothing of it stays on the graph."""

from __future__ import annotations

import warnings
from contextlib import suppress
from typing import TYPE_CHECKING, Any

from rclpy.exceptions import InvalidHandle
from rclpy.task import Future

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rclpy.node import Node


_STOPPED = "was stopped while this call was waiting for its answer"


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
