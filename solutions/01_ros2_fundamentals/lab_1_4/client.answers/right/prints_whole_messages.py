"""Right: prints every message as Python shows it."""
import sys
import rclpy
from action_msgs.msg import GoalStatus
from my_robot_interfaces.action import Fibonacci
from rclpy.action import ActionClient
from rclpy.node import Node

NAMES = {GoalStatus.STATUS_SUCCEEDED: 'succeeded', GoalStatus.STATUS_CANCELED: 'canceled', GoalStatus.STATUS_ABORTED: 'aborted'}


class Sender(Node):
    def __init__(self):
        super().__init__('sender')
        self.actions = ActionClient(self, Fibonacci, 'fibonacci')

    def on_feedback(self, message):
        self.get_logger().info(str(message))

    def wait(self, future):
        rclpy.spin_until_future_complete(self, future)
        return future.result()

    def run(self, order):
        if not self.actions.wait_for_server(timeout_sec=5.0):
            raise SystemExit('action server not available')
        handle = self.wait(self.actions.send_goal_async(Fibonacci.Goal(order=order), feedback_callback=self.on_feedback))
        if not handle.accepted:
            print('goal rejected')
            return
        answer = self.wait(handle.get_result_async())
        print(answer)


def main():
    order = int(sys.argv[1]) if len(sys.argv) > 1 else 10
    rclpy.init()
    Sender().run(order)


if __name__ == '__main__':
    main()
