"""Checks the nodes that a student wants to spin. If they cannot be spun, the error names the mistake."""

from __future__ import annotations

import inspect
from typing import Any

from rclpy.node import Node

from autograder.notebook.cells.cell_output import PlainlyShownError
from autograder.notebook.nodes.kernel_nodes import NodeEndedError, is_destroyed, node_label
from autograder.notebook.nodes.lending_executors import LendingExecutor


class NotANodeError(PlainlyShownError, TypeError):
    """An argument is not a node."""


class UnusableNodeError(PlainlyShownError, NodeEndedError):
    """The node was destroyed, ROS was shut down, or the node's ``__init__`` was not called."""


class NodeBusyError(PlainlyShownError, RuntimeError):
    """The node already spins."""


class SettingError(PlainlyShownError, ValueError):
    """An option, such as the number of threads, is not valid."""


def check_nodes(caller: str, nodes: tuple[Any, ...]) -> None:
    """Check that all nodes can be spun together.

    Args:
        caller: The name of the function that the student called, for the messages.
        nodes: The arguments of this call.

    Raises:
        NotANodeError: An argument is not a node, or there are no arguments.
        UnusableNodeError: A node was destroyed, ROS was shut down after it was made, or its ``__init__`` was skipped.
        NodeBusyError: A node already spins, or is given twice.
    """
    if not nodes:
        raise NotANodeError(f"{caller}() needs at least one node, such as {caller}(TalkerNode())")
    for node in nodes:
        _check_is_node(caller, node)
        _check_is_usable(node)
        _check_is_idle(node)
    if len({id(node) for node in nodes}) < len(nodes):
        raise NodeBusyError(f"{caller}() was given the same node twice: give each node once")
    if len({id(node.context) for node in nodes}) > 1:
        raise UnusableNodeError(
            "these nodes belong to different ROS contexts, and one executor serves only one context: "
            f"call {caller}() separately for the nodes of each context"
        )


def check_threads(threads: Any) -> None:
    """Check that a number of threads is valid.

    Raises:
        SettingError: The number is not a whole number of at least 1.
    """
    if not isinstance(threads, int) or isinstance(threads, bool) or threads < 1:
        raise SettingError(f"threads must be a whole number of at least 1, not {threads!r}")


def _check_is_node(caller: str, thing: Any) -> None:
    if isinstance(thing, Node):
        return
    if isinstance(thing, type):
        kind = "a class" if issubclass(thing, Node) else "a class that is not derived from Node"
        raise NotANodeError(
            f"{thing.__name__} is {kind}. Add parentheses to make a node of it: {caller}({thing.__name__}())"
        )
    if isinstance(thing, list | tuple | set):
        raise NotANodeError(
            f"{caller}() takes nodes one by one, not in a {type(thing).__name__}: "
            f"{caller}(TalkerNode(), ListenerNode()), or {caller}(*nodes)"
        )
    if inspect.isroutine(thing):
        raise NotANodeError(
            f"{thing.__name__} is a function. Call it, if it returns a node: {caller}({thing.__name__}())"
        )
    if thing is None:
        raise NotANodeError(
            f"{caller}() was given None. A function that makes a node must end with `return node`"
        )
    raise NotANodeError(
        f"{caller}() takes nodes, but this argument is of type {type(thing).__name__}: {thing!r}"
    )


def _check_is_usable(node: Node) -> None:
    kind = type(node).__name__
    try:
        destroyed = is_destroyed(node)
    except AttributeError:
        raise UnusableNodeError(
            f'{kind} is not initialized as a node: begin its __init__ with super().__init__("a_name")'
        ) from None
    if destroyed:
        raise UnusableNodeError(
            f"this {kind} has been destroyed (`with spinning(...)` and .stop() do that at their end). "
            f"Make a new one: {kind}()"
        )
    if not node.context.ok():
        raise UnusableNodeError(
            f"ROS was shut down after this {kind} had been made. "
            f"Call start_ros(), then make a new one: {kind}()"
        )


def _check_is_idle(node: Node) -> None:
    executor = node.executor
    if executor is None or node not in executor.get_nodes():
        return
    name = node_label(node)
    if isinstance(executor, LendingExecutor):
        raise NodeBusyError(
            f"{name} spins in the background already: let it spin, or first call .stop() on what spin_in_background() "
            "returned"
        )
    raise NodeBusyError(
        f"{name} is in another executor already ({type(executor).__name__}): "
        "end rclpy.spin() there, or call that executor's remove_node() first"
    )
