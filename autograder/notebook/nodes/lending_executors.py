"""rclpy's two executors, extended: they get back nodes that rclpy moves to another executor, and report failed goals.

A node is in one executor at a time. ``rclpy.spin_once(node)`` and ``rclpy.spin_until_future_complete(node, …)`` move
the node into rclpy's global executor, and afterwards leave the node without an executor (``rclpy/__init__.py``,
``rclpy/node.py``). A node that spun in the background would then receive nothing any more. The executors of this module
only lend the node, that is, they add it again afterwards.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import rclpy
from rclpy.action.server import ActionServer
from rclpy.executors import Executor, MultiThreadedExecutor, SingleThreadedExecutor, await_or_execute

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable
    from types import FrameType

    from rclpy.context import Context
    from rclpy.node import Node
    from rclpy.task import Task

    GoalErrorReport = Callable[[BaseException, ActionServer], None]


@dataclass(frozen=True)
class NodeTaken:
    """The event that a node was moved out of its executor.

    Attributes:
        node: The node.
        caller: The rclpy function that moved the node, such as ``"spin_once"``; None if it was the ``add_node`` of
            another executor.
        comes_back: True if the node returns to its executor when this function ends.
    """

    node: Node
    caller: str | None
    comes_back: bool


class LendingExecutor(Executor):
    """An executor that lends its nodes. This module's two executors inherit from it, and from an executor of rclpy."""

    on_taken: Callable[[NodeTaken], None] | None = None
    """Called after a node was moved to another executor, in the thread that moved it."""
    on_goal_error: GoalErrorReport | None = None
    """Called with the error of an action server's execute callback."""

    def create_task(self, callback: Any, *args: Any, **kwargs: Any) -> Task:
        """Schedule a task. rclpy's action servers use this to execute goals."""
        if self.on_goal_error is not None:
            args = _report_goal_errors(callback, args, self.on_goal_error)
        return super().create_task(callback, *args, **kwargs)

    def release(self, node: Node) -> None:
        """Remove a node for good, without calling ``on_taken``."""
        on_taken, self.on_taken = self.on_taken, None
        try:
            super().remove_node(node)
        finally:
            self.on_taken = on_taken

    def remove_node(self, node: Node) -> None:
        """Lend a node to another executor. rclpy calls this when that executor's ``add_node`` is called."""
        had_it = node in self.get_nodes()
        super().remove_node(node)
        if not had_it or self.on_taken is None:
            return
        borrower = _global_executor()
        comes_back = borrower is not None and node in borrower.get_nodes()
        if borrower is not None and comes_back:
            _return_afterwards(borrower, node, self)
        self.on_taken(NodeTaken(node, _spinning_function(sys._getframe(1)), comes_back))

    def take_back(self, node: Node) -> None:
        """Spin a lent node again."""
        if self.on_taken is not None:
            self.add_node(node)


class _LendingSingleThreadedExecutor(LendingExecutor, SingleThreadedExecutor):
    pass


class _LendingMultiThreadedExecutor(LendingExecutor, MultiThreadedExecutor):
    pass


def make_executor(threads: int, context: Context) -> LendingExecutor:
    """Return a lending executor with this number of threads, for nodes of a ROS context."""
    if threads == 1:
        return _LendingSingleThreadedExecutor(context=context)
    return _LendingMultiThreadedExecutor(num_threads=threads, context=context)


def wake_global_executor() -> None:
    """Wake a callback that waits inside ``rclpy.spin_once()``, so that an exception can be raised in its thread."""
    executor = _global_executor()
    if executor is not None:
        executor.wake()


def _report_goal_errors(task: Any, arguments: tuple[Any, ...], report: GoalErrorReport) -> tuple[Any, ...]:
    """Return the arguments for a task of rclpy, changed to report errors if the task executes an action's goal.

    rclpy itself catches an error in the execute callback and prints the traceback to standard error, among other lines
    (``ActionServer._execute_goal`` in ``rclpy/action/server.py``). With the changed arguments, the error is reported
    like an error in any other callback. The goal still ends as in rclpy: aborted, with an empty result.

    Args:
        task: The function that the executor is to run.
        arguments: The arguments of the task.
        report: Called with the error of an execute callback and the action server.
    """
    server = getattr(task, "__self__", None)
    if not isinstance(server, ActionServer) or getattr(task, "__name__", "") != "_execute_goal":
        return arguments
    execute_callback, *rest = arguments
    return (_guarded(execute_callback, server, report), *rest)


def _guarded(
    execute_callback: Any, server: ActionServer, report: GoalErrorReport
) -> Callable[[Any], Awaitable[Any]]:
    result_type = server._action_type.Result

    async def execute(goal_handle: Any) -> Any:
        try:
            result = await await_or_execute(execute_callback, goal_handle)
            if not isinstance(result, result_type):
                raise TypeError(
                    "the execute callback must return a result of the action: "
                    f"end it with `return result`, not with {result!r}"
                )
        except Exception as error:
            report(error, server)
            return result_type()
        return result

    return execute


def _global_executor() -> Executor | None:
    """Return rclpy's global executor; None if there is none. ``rclpy.get_global_executor`` would create one."""
    executor: Executor | None = getattr(rclpy, "__executor", None)
    return executor


_LOANS = "_nodes_to_return"
"""The attribute of a borrowing executor that contains the owners of the lent nodes, by the id of the node."""


def _return_afterwards(borrower: Any, node: Node, owner: LendingExecutor) -> None:
    """Change the executor that borrows a node: when it removes the node, it gives the node back to the owner."""
    if _LOANS not in vars(borrower):
        loans: dict[int, LendingExecutor] = {}
        plain_remove_node = borrower.remove_node

        def remove_node(lent: Node) -> None:
            plain_remove_node(lent)
            if (its_owner := loans.pop(id(lent), None)) is not None:
                its_owner.take_back(lent)

        setattr(borrower, _LOANS, loans)
        borrower.remove_node = remove_node
    getattr(borrower, _LOANS)[id(node)] = owner


_RCLPY_SPINS = frozenset({"spin", "spin_once", "spin_until_future_complete"})


def _spinning_function(frame: FrameType | None) -> str | None:
    """Return the rclpy function on the call stack that spins a node, such as ``"spin_once"``; None if there is none."""
    while frame is not None:
        if frame.f_globals.get("__name__") == "rclpy" and frame.f_code.co_name in _RCLPY_SPINS:
            return frame.f_code.co_name
        frame = frame.f_back
    return None
