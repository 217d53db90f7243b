"""`ros2 action send_goal`."""

from __future__ import annotations

import signal
from typing import TYPE_CHECKING, Any

from course_runtime.ros2_command.commands import Outcome, Verb
from course_runtime.ros2_command.graph_node import NAME_PREFIX, graph_node
from course_runtime.ros2_command.interface_types import load_type
from course_runtime.ros2_command.messages import fill, parse_values, to_yaml
from course_runtime.ros2_command.values_argument import add_values_argument, given_values

if TYPE_CHECKING:
    import argparse

    from rclpy.node import Node
    from rclpy.task import Future

_POLL = 0.05  # seconds between two checks for Ctrl-C
# The names of the status numbers of action_msgs/msg/GoalStatus.
_STATUS = ("UNKNOWN", "ACCEPTED", "EXECUTING", "CANCELING", "SUCCEEDED", "CANCELED", "ABORTED")
_ACCEPTED, _EXECUTING = 1, 2


def _arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("action_name", help="Name of the ROS action (e.g. '/fibonacci')")
    parser.add_argument(
        "action_type", help="Type of the ROS action (e.g. 'example_interfaces/action/Fibonacci')"
    )
    add_values_argument(
        parser,
        "goal",
        "Goal request values in YAML format (e.g. '{order: 10}')",
        "Read goal from standard input",
    )
    parser.add_argument("-f", "--feedback", action="store_true", help="Echo feedback messages for the goal")


class _Feedback:
    """Shows feedback, but only after the line that the goal is accepted, because that answer may come later."""

    def __init__(self) -> None:
        self._early: list[Any] | None = []

    def __call__(self, message: Any) -> None:
        """Show one feedback message, or keep it for later."""
        if self._early is None:
            print(f"Feedback:\n    {to_yaml(message.feedback)}")
        else:
            self._early.append(message)

    def begin(self) -> None:
        """Show the feedback that was kept. From now on, show feedback at once."""
        early, self._early = self._early or [], None
        for message in early:
            self(message)


class _Turns:
    """Runs the executor turn by turn. Ctrl-C takes effect between two turns and never within one.

    If an exception comes while a message for an action client is being taken, rclpy waits for no further message of
    that client (`_executor_event` in rclpy/executors.py). The answer to the cancel request would then be lost.
    """

    def __init__(self, node: Node) -> None:
        self._node = node
        self._interrupted = False
        # If Ctrl-C is ignored, as in a background job of a script, it stays ignored.
        if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
            signal.signal(signal.SIGINT, self._interrupt)

    def _interrupt(self, *_: object) -> None:
        self._interrupted = True

    def take_one(self) -> None:
        """Spin once, unless Ctrl-C was pressed."""
        import rclpy

        self.heed()
        rclpy.spin_once(self._node, timeout_sec=_POLL)

    def heed(self) -> None:
        """Do what Python does at Ctrl-C, if Ctrl-C was pressed.

        Raises:
            KeyboardInterrupt: Ctrl-C was pressed since the last call.
        """
        if self._interrupted:
            self._interrupted = False
            raise KeyboardInterrupt

    def until_done(self, future: Future) -> Any:
        """Spin until a future is done, and return its result.

        If Ctrl-C comes in the turn that brings the result, it takes effect in the next wait, so a goal that was just
        accepted is canceled.
        """
        while not future.done():
            self.take_one()
        return future.result()


def _cancel(turns: _Turns, handle: Any) -> None:
    """Cancel a goal whose result is no longer awaited.

    Raises:
        RuntimeError: The server did not cancel the goal.
    """
    print("Canceling goal...")
    response = turns.until_done(handle.cancel_goal_async())
    canceling = [info.goal_id for info in response.goals_canceling]
    if handle.goal_id not in canceling:
        raise RuntimeError("Failed to cancel goal")
    print("Goal canceled.")


def _send_goal(args: argparse.Namespace) -> Outcome:
    try:
        action = load_type(args.action_type, "action")
    except ValueError:
        return "The passed action type is invalid"
    goal = action.Goal()
    values = parse_values(given_values(args, "goal"))
    try:
        fill(goal, values)
    except Exception as error:
        return f"Failed to populate message fields: {error!r}"
    name = f"{NAME_PREFIX}_send_goal_{args.action_type.replace('/', '_')}"
    # ROS must continue after Ctrl-C, or the goal could not be canceled.
    with graph_node(name=name, handle_interrupt=False) as node:
        from rclpy.action.client import ActionClient

        client = ActionClient(node, action, args.action_name)
        turns = _Turns(node)
        handle = None
        try:
            print("Waiting for an action server to become available...")
            while not client.server_is_ready():
                turns.take_one()
            turns.heed()
            print(f"Sending goal:\n     {to_yaml(goal)}")
            feedback = _Feedback()
            handle = turns.until_done(client.send_goal_async(goal, feedback if args.feedback else None))
            if not handle.accepted:
                print("Goal was rejected.")
                return None
            print(f"Goal accepted with ID: {bytes(handle.goal_id.uuid).hex()}\n")
            feedback.begin()
            result = turns.until_done(handle.get_result_async())
            print(f"Result:\n    {to_yaml(result.result)}")
            status = result.status if 0 <= result.status < len(_STATUS) else 0
            print(f"Goal finished with status: {_STATUS[status]}")
        except KeyboardInterrupt:
            if handle is not None and handle.status in (0, _ACCEPTED, _EXECUTING):
                _cancel(turns, handle)
            raise
        finally:
            client.destroy()
    return None


VERBS = {"send_goal": Verb(_arguments, _send_goal)}
