# Right: one line for each end: "goal succeeded: True", or "goal succeeded: False" for one that was aborted, which is not false; a refused one is REJECTED.
import sys

import rclpy
from action_msgs.msg import GoalStatus
from my_robot_interfaces.action import Fibonacci
from rclpy.action import ActionClient
from rclpy.node import Node


class FibonacciClient(Node):
    def __init__(self):
        super().__init__('fibonacci_client')
        self.actions = ActionClient(self, Fibonacci, 'fibonacci')

    def on_feedback(self, message):
        self.get_logger().info(f'feedback: {list(message.feedback.partial_sequence)}')

    def wait(self, future):
        rclpy.spin_until_future_complete(self, future)
        return future.result()

    def run(self, order):
        if not self.actions.wait_for_server(timeout_sec=5.0):
            raise TimeoutError('fibonacci is not available')
        goal_handle = self.wait(
            self.actions.send_goal_async(Fibonacci.Goal(order=order), feedback_callback=self.on_feedback)
        )
        if not goal_handle.accepted:
            self.get_logger().error('REJECTED')
            return
        answer = self.wait(goal_handle.get_result_async())
        succeeded = answer.status == GoalStatus.STATUS_SUCCEEDED
        self.get_logger().info(f'goal succeeded: {succeeded}')
        print(*answer.result.sequence if succeeded else ['status', answer.status])


def main():
    rclpy.init()
    try:
        FibonacciClient().run(int(sys.argv[1]))
    except TimeoutError as problem:
        print('gave up:', problem)
    finally:
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
