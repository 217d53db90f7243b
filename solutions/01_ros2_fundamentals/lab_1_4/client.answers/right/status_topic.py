"""Right: sees on the goal's status topic how it ends, and asks for the result of one that has succeeded."""
import sys

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
        self.create_subscription(
            GoalStatusArray, 'fibonacci/_action/status', self.on_status, qos_profile_action_status_default
        )

    def send(self, order):
        goal = Fibonacci.Goal(order=order)
        self.client.send_goal_async(goal, feedback_callback=self.on_feedback).add_done_callback(self.on_answer)

    def on_answer(self, future):
        self.goal = future.result()
        if not self.goal.accepted:
            self.get_logger().error('rejected')
            rclpy.shutdown()

    def on_feedback(self, message):
        self.get_logger().info(f'feedback {list(message.feedback.partial_sequence)}')

    def on_status(self, message):
        for line in message.status_list:
            if self.goal is None or line.goal_info.goal_id != self.goal.goal_id:
                continue
            if line.status == GoalStatus.STATUS_SUCCEEDED:
                self.goal.get_result_async().add_done_callback(self.on_result)
            elif line.status == GoalStatus.STATUS_ABORTED:
                self.get_logger().error('the goal was aborted')
                rclpy.shutdown()

    def on_result(self, future):
        self.get_logger().info(f'result {list(future.result().result.sequence)}')
        rclpy.shutdown()


def main():
    rclpy.init()
    node = Watcher()
    if not node.client.wait_for_server(timeout_sec=5.0):
        raise SystemExit('action server not available')
    node.send(int(sys.argv[1]))
    rclpy.spin(node)


if __name__ == '__main__':
    main()
