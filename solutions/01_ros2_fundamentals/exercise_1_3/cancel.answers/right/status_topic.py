"""Right: sees on the goal's status topic how it ended, and never asks for the result."""
import rclpy
from action_msgs.msg import GoalStatus, GoalStatusArray
from my_robot_interfaces.action import Fibonacci
from rclpy.action import ActionClient
from rclpy.node import Node
from rclpy.qos import qos_profile_action_status_default


class Watcher(Node):
    def __init__(self):
        super().__init__('watcher')
        self.client = ActionClient(self, Fibonacci, 'fibonacci')
        self.goal = None
        self.count = 0
        self.create_subscription(
            GoalStatusArray, 'fibonacci/_action/status', self.on_status, qos_profile_action_status_default
        )

    def on_answer(self, future):
        self.goal = future.result()
        if not self.goal.accepted:
            self.get_logger().error('the goal was rejected')
            raise SystemExit

    def on_feedback(self, message):
        self.count += 1
        if self.count == 3:
            self.goal.cancel_goal_async()

    def on_status(self, message):
        for line in message.status_list:
            if line.status == GoalStatus.STATUS_CANCELED:
                self.get_logger().info('the goal was canceled')
            elif line.status == GoalStatus.STATUS_SUCCEEDED:
                self.get_logger().info('the goal succeeded after all')
            elif line.status == GoalStatus.STATUS_ABORTED:
                self.get_logger().info('the goal was aborted')
            else:
                continue
            raise SystemExit


def main():
    rclpy.init()
    node = Watcher()
    if not node.client.wait_for_server(timeout_sec=5.0):
        raise SystemExit('action server not available')
    node.client.send_goal_async(Fibonacci.Goal(order=20), node.on_feedback).add_done_callback(node.on_answer)
    rclpy.spin(node)


if __name__ == '__main__':
    main()
