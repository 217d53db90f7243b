"""Right: the plain client, step by step."""
import sys

import rclpy
from action_msgs.msg import GoalStatus
from my_robot_interfaces.action import Fibonacci
from rclpy.action import ActionClient
from rclpy.node import Node


class FibonacciClient(Node):
    def __init__(self):
        super().__init__('fibonacci_client')
        self.client = ActionClient(self, Fibonacci, 'fibonacci')

    def on_feedback(self, message):
        self.get_logger().info(f'feedback: {list(message.feedback.partial_sequence)}')

    def run(self, order):
        goal = Fibonacci.Goal()
        goal.order = order
        sending = self.client.send_goal_async(goal, feedback_callback=self.on_feedback)
        rclpy.spin_until_future_complete(self, sending)
        goal_handle = sending.result()
        if not goal_handle.accepted:
            self.get_logger().error('the goal was rejected')
            return
        ending = goal_handle.get_result_async()
        rclpy.spin_until_future_complete(self, ending)
        status, result = ending.result().status, ending.result().result
        if status == GoalStatus.STATUS_SUCCEEDED:
            self.get_logger().info(f'succeeded: {list(result.sequence)}')
        else:
            self.get_logger().error(f'ended with status {status}')


def main():
    order = int(sys.argv[1])
    rclpy.init()
    node = FibonacciClient()
    if not node.client.wait_for_server(timeout_sec=5.0):
        sys.exit('the action server is not available')
    node.run(order)
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
