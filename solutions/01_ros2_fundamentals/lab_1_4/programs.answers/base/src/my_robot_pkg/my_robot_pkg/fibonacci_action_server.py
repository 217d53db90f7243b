import time
from typing import Any

import rclpy
from my_robot_interfaces.action import Fibonacci
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node

LARGEST_ORDER = 46


PERIOD = 0.5


def answer_goal(goal: Fibonacci.Goal) -> GoalResponse:
    """Whether the server takes a goal: its order is from 0 to LARGEST_ORDER."""
    if not 0 <= goal.order <= LARGEST_ORDER:
        return GoalResponse.REJECT
    return GoalResponse.ACCEPT


def compute(goal_handle: Any) -> Fibonacci.Result:
    """Compute the sequence of a goal, with feedback, until it is complete or canceled."""
    numbers = [0, 1]
    while len(numbers) <= goal_handle.request.order and not goal_handle.is_cancel_requested:
        numbers.append(numbers[-2] + numbers[-1])
        goal_handle.publish_feedback(Fibonacci.Feedback(partial_sequence=numbers))
        time.sleep(PERIOD)
    if goal_handle.is_cancel_requested:
        goal_handle.canceled()
    else:
        goal_handle.succeed()
    return Fibonacci.Result(sequence=numbers[: goal_handle.request.order + 1])


class FibonacciServer(Node):
    """Computes the Fibonacci sequence, with feedback, until somebody cancels."""

    def __init__(self) -> None:
        super().__init__("fibonacci_server")
        self.server = ActionServer(
            self,
            Fibonacci,
            "fibonacci",
            goal_callback=answer_goal,
            execute_callback=compute,
            cancel_callback=self.on_cancel,
        )

    def on_cancel(self, goal_handle: Any) -> CancelResponse:
        self.get_logger().info("cancel requested")
        return CancelResponse.ACCEPT


def main() -> None:
    rclpy.init()
    node = FibonacciServer()
    try:
        rclpy.spin(node, executor=MultiThreadedExecutor(num_threads=4))
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
