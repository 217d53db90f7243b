"""Right: the course text's server mended, with names and a log of its own."""
import time

import rclpy
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from my_robot_interfaces.action import Fibonacci


class FibonacciActionServer(Node):
    def __init__(self):
        super().__init__('fibonacci_action_server')
        self._action_server = ActionServer(
            self,
            Fibonacci,
            'fibonacci',
            self.execute_callback,
            goal_callback=self.goal_callback,
            cancel_callback=lambda goal_handle: CancelResponse.ACCEPT,
            callback_group=ReentrantCallbackGroup(),
        )
        self.get_logger().info('Fibonacci action server ready.')

    def goal_callback(self, goal_request):
        if goal_request.order < 0 or goal_request.order > 46:
            self.get_logger().warn(f'refusing order {goal_request.order}')
            return GoalResponse.REJECT
        return GoalResponse.ACCEPT

    def execute_callback(self, goal_handle):
        self.get_logger().info(f'Executing goal: {goal_handle.request.order}')
        numbers = [0, 1]
        while len(numbers) < goal_handle.request.order + 1:
            if goal_handle.is_cancel_requested:
                goal_handle.canceled()
                self.get_logger().info('Goal canceled')
                return Fibonacci.Result(sequence=numbers)
            numbers.append(numbers[-1] + numbers[-2])
            goal_handle.publish_feedback(Fibonacci.Feedback(partial_sequence=numbers))
            time.sleep(0.3)
        goal_handle.succeed()
        return Fibonacci.Result(sequence=numbers)


def main(args=None):
    rclpy.init(args=args)
    server = FibonacciActionServer()
    executor = MultiThreadedExecutor(num_threads=6)
    executor.add_node(server)
    try:
        executor.spin()
    except KeyboardInterrupt:
        server.get_logger().info('bye')
    server._action_server.destroy()
    server.destroy_node()
    rclpy.try_shutdown()


if __name__ == '__main__':
    main()
