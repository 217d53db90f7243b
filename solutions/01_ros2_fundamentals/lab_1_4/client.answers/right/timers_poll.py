"""Right: timers look whether the server and its answer are there; each stops when they are."""
import sys

import rclpy
from action_msgs.msg import GoalStatus
from my_robot_interfaces.action import Fibonacci
from rclpy.action import ActionClient
from rclpy.node import Node


class FibonacciClient(Node):
    def __init__(self, order):
        super().__init__('fibonacci_client')
        self.client = ActionClient(self, Fibonacci, 'fibonacci')
        self.order = order
        self.patience = 100
        self.waiting = self.create_timer(0.05, self.wait_for_server)

    def wait_for_server(self):
        if not self.client.server_is_ready():
            self.patience -= 1
            if self.patience == 0:
                raise SystemExit('the action server is not available')
            return
        self.waiting.cancel()
        self.sending = self.client.send_goal_async(Fibonacci.Goal(order=self.order), feedback_callback=self.on_feedback)
        self.asking = self.create_timer(0.05, self.wait_for_answer)

    def wait_for_answer(self):
        if not self.sending.done():
            return
        self.asking.cancel()
        if not self.sending.result().accepted:
            raise SystemExit('the goal was rejected')
        self.ending = self.sending.result().get_result_async()
        self.ending.add_done_callback(self.on_result)

    def on_feedback(self, message):
        self.get_logger().info(f'feedback: {list(message.feedback.partial_sequence)}')

    def on_result(self, future):
        status, result = future.result().status, future.result().result
        if status == GoalStatus.STATUS_SUCCEEDED:
            self.get_logger().info(f'succeeded: {list(result.sequence)}')
        else:
            self.get_logger().error(f'ended with status {status}')
        raise SystemExit


def main():
    order = int(sys.argv[1])
    rclpy.init()
    rclpy.spin(FibonacciClient(order))


if __name__ == '__main__':
    main()
