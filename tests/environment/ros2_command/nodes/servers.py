"""Serve add_two_ints and fibonacci: an order above 20 is refused, each step takes 20 ms."""

# mypy: disallow-untyped-calls=False

import time
from typing import Any

import rclpy
from my_robot_interfaces.action import Fibonacci
from my_robot_interfaces.srv import AddTwoInts
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node


def add(request: Any, response: Any) -> Any:
    response.sum = request.a + request.b
    return response


def execute(goal: Any) -> Any:
    feedback = Fibonacci.Feedback(partial_sequence=[0, 1])
    while len(feedback.partial_sequence) <= goal.request.order:
        if goal.is_cancel_requested:
            goal.canceled()
            print("was canceled", flush=True)
            return Fibonacci.Result(sequence=feedback.partial_sequence)
        feedback.partial_sequence.append(sum(feedback.partial_sequence[-2:]))
        goal.publish_feedback(feedback)
        time.sleep(0.02 if goal.request.order < 20 else 0.2)
    goal.succeed()
    return Fibonacci.Result(sequence=feedback.partial_sequence)


def main() -> None:
    rclpy.init()
    node = Node("servers", namespace="desk")
    node.create_service(AddTwoInts, "/add_two_ints", add)
    ActionServer(
        node,
        Fibonacci,
        "/fibonacci",
        execute,
        goal_callback=lambda goal: GoalResponse.REJECT if goal.order > 20 else GoalResponse.ACCEPT,
        cancel_callback=lambda _: CancelResponse.ACCEPT,
        callback_group=ReentrantCallbackGroup(),
    )
    print("ready", flush=True)
    executor = MultiThreadedExecutor(4)
    try:
        rclpy.spin(node, executor)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
