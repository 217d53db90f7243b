import sys
from typing import Any

import rclpy
from action_msgs.msg import GoalStatus
from my_robot_interfaces.action import Fibonacci
from rclpy.action import ActionClient
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.task import Future

STATUS_NAMES = {
    GoalStatus.STATUS_SUCCEEDED: "SUCCEEDED",
    GoalStatus.STATUS_CANCELED: "CANCELED",
    GoalStatus.STATUS_ABORTED: "ABORTED",
}
RESULT_PATIENCE = 60.0


def wait_for(node: Node, future: Future, patience_sec: float) -> Any:
    """The result of future; node is spun until it is there.

    Raises TimeoutError when it is not there within patience_sec seconds.
    """
    rclpy.spin_until_future_complete(node, future, timeout_sec=patience_sec)
    if not future.done():
        raise TimeoutError(f"no answer within {patience_sec} s")
    return future.result()


class FibonacciClient(Node):
    """A node with a client of the action fibonacci; it logs each feedback."""

    def __init__(self) -> None:
        super().__init__("fibonacci_client")
        self.actions = ActionClient(self, Fibonacci, "fibonacci")

    def on_feedback(self, message: Any) -> None:
        self.get_logger().info(f"feedback: {list(message.feedback.partial_sequence)}")


def send_goal(client: FibonacciClient, order: int, patience_sec: float) -> Any:
    """Send a goal; returns its handle, whether it was accepted or not.

    Raises TimeoutError when there is no server, or no answer, within patience_sec seconds.
    """
    if not client.actions.wait_for_server(timeout_sec=patience_sec):
        raise TimeoutError(f"the action fibonacci is not available after {patience_sec} s")
    goal = Fibonacci.Goal(order=order)
    future = client.actions.send_goal_async(goal, feedback_callback=client.on_feedback)
    return wait_for(client, future, patience_sec)


def fibonacci(order: int, patience_sec: float = 5.0) -> list[int]:
    """The sequence that the action fibonacci gives for an order; empty where the goal is refused.

    Raises TimeoutError when there is no server, or no answer, within patience_sec seconds.
    """
    client = FibonacciClient()
    try:
        goal_handle = send_goal(client, order, patience_sec)
        if not goal_handle.accepted:
            client.get_logger().error("the goal was REJECTED")
            return []
        answer = wait_for(client, goal_handle.get_result_async(), RESULT_PATIENCE)
        numbers = list(answer.result.sequence)
        client.get_logger().info(f"the goal {STATUS_NAMES[answer.status]}: {numbers}")
        return numbers
    finally:
        client.destroy_node()


def main() -> None:
    order = int(sys.argv[1]) if len(sys.argv) > 1 else 10
    rclpy.init()
    try:
        print(fibonacci(order))
    except TimeoutError as problem:
        print("gave up:", problem)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
