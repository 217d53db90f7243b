"""Errors in the execute callback of an action server.

rclpy catches them itself and prints the traceback on standard error, among lines of its own
(``ActionServer._execute_goal`` in ``rclpy/action/server.py``). Here they take the way of all other callbacks'
errors, and the goal still ends as it does there: aborted, with an empty result.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rclpy.action.server import ActionServer
from rclpy.executors import await_or_execute

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable

    GoalErrorReport = Callable[[BaseException, ActionServer], None]


def report_goal_errors(task: Any, arguments: tuple[Any, ...], report: GoalErrorReport) -> tuple[Any, ...]:
    """The arguments for a task of an executor, changed where it is an action server's that executes a goal.

    Args:
        task: The function that the executor is to run.
        arguments: What it is to be given.
        report: Called with an error of the execute callback, and the server.
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
