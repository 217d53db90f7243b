"""Right: says plainly when the goal was not canceled after all, with the number of the status it got."""
import rclpy
from action_msgs.msg import GoalStatus
from my_robot_interfaces.action import Fibonacci
from rclpy.action import ActionClient
from rclpy.node import Node


class HonestClient(Node):
    def __init__(self):
        super().__init__('honest_client')
        self.client = ActionClient(self, Fibonacci, 'fibonacci')
        self.canceled_after = 0
        self.seen = 0
        self.goal = None

    def feedback(self, msg):
        self.seen += 1
        if self.seen >= 4 and not self.canceled_after:
            self.canceled_after = self.seen
            self.get_logger().info(f'asking to be canceled after {self.seen}')
            self.goal.cancel_goal_async()

    def finished(self, future):
        outcome = future.result()
        if outcome.status == GoalStatus.STATUS_CANCELED:
            self.get_logger().info(f'canceled, with {len(outcome.result.sequence)} numbers')
        else:
            self.get_logger().error(f'NOT canceled: the goal ended with status {outcome.status}')
        raise SystemExit


def main():
    rclpy.init()
    node = HonestClient()
    node.client.wait_for_server(timeout_sec=10.0)
    sending = node.client.send_goal_async(Fibonacci.Goal(order=20), feedback_callback=node.feedback)
    rclpy.spin_until_future_complete(node, sending)
    node.goal = sending.result()
    if not node.goal.accepted:
        raise RuntimeError('the goal was not accepted (rejected)')
    node.goal.get_result_async().add_done_callback(node.finished)
    rclpy.spin(node)


if __name__ == '__main__':
    main()
