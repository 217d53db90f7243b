"""Spinning nodes in the background of a notebook.

``with spinning(TalkerNode(), ListenerNode()): …`` spins nodes while the cell's body runs;
``spin_in_background(TalkerNode())`` spins them until they are stopped or the cell is run again.
"""

from __future__ import annotations

import atexit
from typing import TYPE_CHECKING, Any

from autograder.notebook.cells.student_tracebacks import point_at_raising_lines
from autograder.notebook.nodes.background import Background, end_everything, replace_named
from autograder.notebook.nodes.callback_errors import CallbackFailedError
from autograder.notebook.nodes.node_ends import node_label
from autograder.notebook.nodes.ros_session import RosSession, prepare_environment, start_ros
from autograder.notebook.nodes.usable_nodes import SettingError, check_nodes, check_threads

if TYPE_CHECKING:
    from types import TracebackType

    from rclpy.node import Node

__all__ = ["Background", "RosSession", "Spinning", "spin_in_background", "spinning", "start_ros", "stop_all"]

_GRACE_AT_EXIT = 0.5
"""Seconds; a kernel that takes more than five to end is killed (``KernelManager.shutdown_wait_time``)."""


def spinning(*nodes: Node, threads: int = 1) -> Spinning:
    """Spin nodes in the background while a ``with`` block runs.

    ``as`` gives the node, or a tuple of them where there are several::

        with spinning(TalkerNode(), ListenerNode()) as (talker, listener):
            time.sleep(3)

    At the end of the block, however it ends, the executor is shut down, its threads are joined and the nodes
    are destroyed. The executor is the nodes' own context's.

    Args:
        nodes: At least one node.
        threads: How many callbacks may run at a time. From 2 on the executor is a MultiThreadedExecutor.

    Raises:
        NotANodeError: Something given is not a node.
        UnusableNodeError: A node has ended.
        NodeBusyError: A node spins already.
        SettingError: ``threads`` is not a number of threads.
        CallbackFailedError: At the end of the block, when a callback raised and the block itself did not.
    """
    check_nodes("spinning", nodes)
    check_threads(threads)
    return Spinning(nodes, threads)


def spin_in_background(node: Node, *more: Node, name: str | None = None, threads: int = 1) -> Background:
    """Spin nodes in the background until ``.stop()``, or until this cell is run again.

    Running the cell again first ends what its earlier run left spinning, and the nodes that run made. With a
    ``name`` of its own, a background outlasts that: only one of the same name takes its place.

    Args:
        node: A node.
        more: More nodes for the same executor.
        name: Tells this background from others that the same cell starts.
        threads: How many callbacks may run at a time. From 2 on the executor is a MultiThreadedExecutor.

    Raises:
        NotANodeError: Something given is not a node.
        UnusableNodeError: A node has ended.
        NodeBusyError: A node spins already.
        SettingError: ``threads`` is not a number of threads, or ``name`` not a text.
    """
    nodes = (node, *more)
    check_threads(threads)
    if name is not None:
        if not isinstance(name, str) or not name:
            raise SettingError(f'name must be a string, such as name="talker", not {name!r}')
        replace_named(name, keep=nodes)
    check_nodes("spin_in_background", nodes)
    background = Background(nodes, threads=threads, name=name)
    background.start()
    return background


def stop_all() -> None:
    """Stop all that spins in the background and destroy every node made in this notebook."""
    end_everything()


class Interrupted(KeyboardInterrupt):
    """The kernel was interrupted within ``with spinning(...)``; shown as one line instead of a traceback."""

    def _render_traceback_(self) -> list[str]:
        return [str(self)]


class Spinning:
    """The result of ``spinning(...)``, for a ``with`` statement."""

    def __init__(self, nodes: tuple[Node, ...], threads: int) -> None:
        self._label = ", ".join(map(node_label, nodes))
        self._nodes = nodes
        self._background = Background(nodes, threads=threads)

    def __enter__(self) -> Any:
        """Begin to spin; the node, or a tuple of several."""
        check_nodes("spinning", self._nodes)
        self._background.start()
        return self._nodes[0] if len(self._nodes) == 1 else self._nodes

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """End the nodes."""
        self._background.end()
        if kind is KeyboardInterrupt:
            raise Interrupted(f"Interrupted: {self._label} stopped.") from None
        if error is None and self._background.errors:
            raise CallbackFailedError(self._background.errors) from self._background.errors[0].error

    def __repr__(self) -> str:
        """One line for the end of a cell in which ``with`` was forgotten."""
        return (
            f"{self._label} not spinning: write `with spinning(...):` and indent what is to happen meanwhile."
        )


prepare_environment()
point_at_raising_lines()
# The threads must be gone before the interpreter goes: see spin_threads.
atexit.register(end_everything, grace=_GRACE_AT_EXIT)
