"""Spins nodes in the background of a notebook, and ends them when their cell is run again.

``with spinning(TalkerNode(), ListenerNode()): …`` spins nodes while the ``with`` block runs.
``spin_in_background(TalkerNode())`` spins a node until it is stopped or the cell is run again.
"""

from __future__ import annotations

import atexit
import threading
from typing import TYPE_CHECKING, Any

from autograder.notebook.cell_output import let_log_lines_arrive, point_at_raising_lines, say
from autograder.notebook.cell_runs import CellTracker, TrackedRun
from autograder.notebook.nodes import action_types
from autograder.notebook.nodes.node_errors import (
    CallbackError,
    CallbackErrors,
    CallbackFailedError,
    SettingError,
    check_nodes,
    check_threads,
)
from autograder.notebook.nodes.ros_session import (
    KernelNodes,
    NodeIdentity,
    destroy_node,
    node_label,
    prepare_environment,
)
from autograder.notebook.nodes.spin_threads import GRACE, SpinEnding, SpinThreads

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence
    from types import TracebackType

    from rclpy.context import Context
    from rclpy.node import Node

    from autograder.notebook.nodes.lending_executors import NodeTaken


_GRACE_AT_EXIT = 0.5
"""Seconds to wait for running callbacks when the kernel ends. It is short, because Jupyter kills a kernel that takes
more than five seconds to end (``KernelManager.shutdown_wait_time``).
"""


def spinning(*nodes: Node, threads: int = 1) -> Spinning:
    """Spin nodes in the background while a ``with`` block runs.

    ``as`` gives the node or, if there are several, a tuple of the nodes::

        with spinning(TalkerNode(), ListenerNode()) as (talker, listener):
            time.sleep(3)

    At the end of the block, even after an error, the executor is shut down, its threads are joined and the nodes are
    destroyed. The executor has the same ROS context as the nodes.

    Args:
        nodes: At least one node.
        threads: The number of callbacks that may run at the same time. With 2 or more, the executor is a
            MultiThreadedExecutor.

    Raises:
        NotANodeError: An argument is not a node.
        UnusableNodeError: A node has ended.
        NodeBusyError: A node spins already.
        SettingError: ``threads`` is not a valid number of threads.
        CallbackFailedError: A callback raised an exception, and the block did not. This error is raised at the end of
            the block.
    """
    check_nodes("spinning", nodes)
    check_threads(threads)
    return Spinning(nodes, threads)


def spin_in_background(node: Node, *more: Node, name: str | None = None, threads: int = 1) -> Background:
    """Spin nodes in the background until ``.stop()``, or until this cell is run again.

    When the cell is run again, the nodes of its previous run are stopped and destroyed first. Nodes with a ``name``
    keep spinning instead, until ``spin_in_background`` is called again with the same name.

    Args:
        more: Further nodes for the same executor.
        name: A name for these nodes, so that a later call with the same name replaces them.
        threads: The number of callbacks that may run at the same time. With 2 or more, the executor is a
            MultiThreadedExecutor.

    Raises:
        NotANodeError: An argument is not a node.
        UnusableNodeError: A node has ended.
        NodeBusyError: A node spins already.
        SettingError: ``threads`` is not a valid number of threads, or ``name`` is not a string.
    """
    nodes = (node, *more)
    check_threads(threads)
    if name is not None:
        if not isinstance(name, str) or not name:
            raise SettingError(f'name must be a string, such as name="talker", not {name!r}')
        # End the old nodes before the new ones are checked: a node that is given again would still count as busy.
        replace_named(name, keep=nodes)
    check_nodes("spin_in_background", nodes)
    background = Background(nodes, threads=threads, name=name)
    background.start()
    return background


def stop_all(grace: float = GRACE) -> None:
    """Stop all nodes that spin in the background, and destroy every node that was made in this notebook.

    Args:
        grace: Seconds for each running callback to return by itself.
    """
    for background in _running_backgrounds():
        background.end(grace=grace)
    for made in _made.alive():
        destroy_node(made.node)


class Background:
    """Nodes that spin while other cells run. ``spin_in_background`` returns this object.

    Args:
        nodes: At least one node. They have already been checked.
        threads: The number of callbacks that may run at the same time.
        name: The name that the student gave; None if there is none.
    """

    def __init__(self, nodes: Sequence[Node], *, threads: int = 1, name: str | None = None) -> None:
        self.name = name
        self.run: TrackedRun | None = _cells.current
        self._size = threads
        self._label = ", ".join(node_label(node) for node in nodes)
        self._errors = CallbackErrors()
        self._threads = SpinThreads(
            nodes, threads=threads, on_failure=self._errors.record, on_end=self._when_ended
        )
        self._threads.executor.on_taken = self._when_taken

    @property
    def nodes(self) -> tuple[Node, ...]:
        """The nodes, in the order in which they were given."""
        return self._threads.nodes

    @property
    def running(self) -> bool:
        """True if the nodes spin."""
        return self._threads.running

    @property
    def errors(self) -> tuple[CallbackError, ...]:
        """The errors in callbacks so far. An error that has happened several times is listed once, with a count."""
        return self._errors.all

    def start(self) -> None:
        """Start spinning."""
        with _lock:
            _running.append(self)
        self._threads.start()

    def stop(self) -> None:
        """Stop spinning and destroy the nodes. A second call does nothing."""
        was_running = self.running
        self.end()
        if was_running:
            self._errors.show_counts()

    def end(self, *, keep: Collection[Node] = (), grace: float = GRACE) -> None:
        """Stop spinning, and destroy the nodes except some that are to be spun again.

        Args:
            keep: The nodes that are not destroyed.
            grace: Seconds for a running callback to return by itself.
        """
        for node in self.nodes:
            if any(node is kept for kept in keep):
                self._threads.let_go(node)
        try:
            self._threads.stop(grace)
        except KeyboardInterrupt:
            # The student has interrupted the kernel again. End the threads at once, so that none is left.
            self._threads.stop(grace=0.0)
            raise
        let_log_lines_arrive()

    def drop(self, node: Node) -> None:
        """Stop spinning one node and destroy it. If no node is left, end the background."""
        self._threads.let_go(node)
        destroy_node(node)
        if not self.nodes:
            self.end()

    def __enter__(self) -> Background:
        return self

    def __exit__(self, *exception: object) -> None:
        self.stop()

    def __repr__(self) -> str:
        """Return one line, shown if this is the last expression of a cell."""
        name = f"{self.name}: " if self.name else ""
        if not self.running:
            return f"{name}{self._label} stopped."
        threads = f" in {self._size} threads" if self._size > 1 else ""
        trouble = f" Errors so far: {sum(error.count for error in self.errors)}." if self.errors else ""
        return f"{name}{self._label} spinning in the background{threads}. .stop() ends it.{trouble}"

    def _when_ended(self, ending: SpinEnding) -> None:
        with _lock:
            if self in _running:
                _running.remove(self)
        if ending is SpinEnding.ROS_SHUT_DOWN:
            say(
                f"ROS was shut down, so {self._label} spins no longer. "
                "To go on, call start_ros() and run the cell again that made the node."
            )
        elif ending is SpinEnding.CALLBACK_ASKED:
            say(f"A callback raised SystemExit, so {self._label} spins no longer.")
        elif ending is SpinEnding.EXECUTOR_FAILED:
            say(f"The executor failed, so {self._label} spins no longer. Run the cell again.")

    def _when_taken(self, taken: NodeTaken) -> None:
        name = node_label(taken.node)
        if self._threads.is_own_thread() and taken.caller:
            say(
                f"A callback of {name} calls rclpy.{taken.caller}(). A callback must not spin its own node: "
                "the answer that it waits for may never come. Use `await`, or add_done_callback()."
            )
        elif not taken.comes_back:
            say(f"{name} was added to another executor, so it spins in the background no longer.")
        elif taken.caller == "spin":
            say(
                f"{name} spins in the background already. rclpy.spin() blocks this cell: "
                "interrupt the kernel to go on."
            )


class Interrupted(KeyboardInterrupt):
    """The kernel was interrupted inside ``with spinning(...)``. A notebook shows one line instead of a traceback."""

    def _render_traceback_(self) -> list[str]:
        return [str(self)]


class Spinning:
    """The object that ``spinning(...)`` returns, for use in a ``with`` statement."""

    def __init__(self, nodes: tuple[Node, ...], threads: int) -> None:
        self._label = ", ".join(map(node_label, nodes))
        self._nodes = nodes
        self._background = Background(nodes, threads=threads)

    def __enter__(self) -> Any:
        """Start spinning. Return the node or, if there are several, a tuple of the nodes."""
        check_nodes("spinning", self._nodes)
        self._background.start()
        return self._nodes[0] if len(self._nodes) == 1 else self._nodes

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Stop spinning and destroy the nodes."""
        self._background.end()
        if kind is KeyboardInterrupt:
            raise Interrupted(f"Interrupted: {self._label} stopped.") from None
        if error is None and self._background.errors:
            raise CallbackFailedError(self._background.errors) from self._background.errors[0].error

    def __repr__(self) -> str:
        """Return the line that a notebook shows if a cell ends with ``spinning(...)`` without ``with``."""
        return f"{self._label} not spinning: write `with spinning(...):` and indent the lines that run meanwhile."


def replace_named(name: str, keep: Collection[Node]) -> None:
    """Stop the nodes that spin in the background under this name, and destroy them except those in ``keep``."""
    for background in _running_backgrounds():
        if background.name == name:
            background.end(keep=keep)


def _running_backgrounds() -> list[Background]:
    """Return the :class:`Background` of all nodes that spin in the background, the oldest first."""
    with _lock:
        return list(_running)


def _background_of(node: Node) -> Background | None:
    return next((b for b in _running_backgrounds() if any(node is other for other in b.nodes)), None)


def _undo_earlier_run(run: TrackedRun) -> None:
    """End the nodes of a cell's previous run before the cell is run again. Their messages would mix with the new ones.

    A node that was made in another cell is only stopped and not destroyed, because a later cell may use its variable. A
    background with a name keeps running.
    """
    left_behind = []
    for made in _made.alive():
        background = _background_of(made.node)
        is_named = background is not None and background.name is not None
        if run.is_later_run_of(made.run) and not is_named:
            left_behind.append(made.node)
    for background in _running_backgrounds():
        if background.name is None and run.is_later_run_of(background.run):
            from_elsewhere = [
                node for node in background.nodes if not any(node is other for other in left_behind)
            ]
            background.end(keep=from_elsewhere)
    for node in left_behind:
        _end_node(node)


def _make_room(newcomer: NodeIdentity) -> None:
    """Before a node is made, destroy a node with the same name from another cell, because messages would come twice.

    If both nodes existed, rcl would warn, and destroying one of them would end the log of both. If one run of a cell
    makes two nodes with the same name, both stay, because a lab of the course shows what two servers with one name do.
    """
    for made in _made.alive():
        if made.identity == newcomer and made.run != _cells.current:
            background = _background_of(made.node)
            if background is not None and background.running:
                say(
                    f"A {node_label(made.node)} of an earlier cell was still spinning. "
                    "It was stopped, so that no message comes twice."
                )
            _end_node(made.node)


def _end_node(node: Node) -> None:
    background = _background_of(node)
    if background is not None:
        background.drop(node)
    else:
        destroy_node(node)


def destroy_nodes_on(context: Context) -> None:
    """Destroy every node of a ROS context. Call this before the context is shut down."""
    for node in _made.on(context):
        destroy_node(node)


_running: list[Background] = []
_lock = threading.Lock()
_cells = CellTracker()
_made = KernelNodes(current_run=lambda: _cells.current, before_making=_make_room)
_made.start_recording()
action_types.check_from_now_on()
_cells.before_each_run(_undo_earlier_run)
prepare_environment()
point_at_raising_lines()
# The spinning threads must end before the interpreter ends. The docstring of spin_threads.py gives the reason.
atexit.register(stop_all, grace=_GRACE_AT_EXIT)
