"""Right: other threads read the requests while one counts."""

import time

import rclpy
from my_robot_interfaces.action import Fibonacci
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node


class FibonacciServer(Node):
    def __init__(self):
        super().__init__("fibonacci_server")
        self.server = ActionServer(
            self,
            Fibonacci,
            "fibonacci",
            goal_callback=self.on_goal,
            execute_callback=self.compute,
            cancel_callback=self.on_cancel,
        )

    def on_goal(self, goal):
        return GoalResponse.ACCEPT if 0 <= goal.order <= 46 else GoalResponse.REJECT

    def on_cancel(self, goal_handle):
        self.get_logger().info("cancel requested")
        return CancelResponse.ACCEPT

    def compute(self, goal_handle):
        numbers = [0, 1]
        while len(numbers) <= goal_handle.request.order and not goal_handle.is_cancel_requested:
            numbers.append(numbers[-2] + numbers[-1])
            goal_handle.publish_feedback(Fibonacci.Feedback(partial_sequence=numbers))
            time.sleep(0.1)
        if goal_handle.is_cancel_requested:
            goal_handle.canceled()
        else:
            goal_handle.succeed()
        return Fibonacci.Result(sequence=numbers[: goal_handle.request.order + 1])


rclpy.init()
rclpy.spin(FibonacciServer(), executor=MultiThreadedExecutor(num_threads=4))
