"""Wrong: the course text's three seconds are six or seven feedbacks."""
import rclpy
from action_msgs.msg import GoalStatus
from my_robot_interfaces.action import Fibonacci
from rclpy.action import ActionClient
from rclpy.node import Node


class CancelingClient(Node):
    def __init__(self):
        super().__init__('canceling_client')
        self.client = ActionClient(self, Fibonacci, 'fibonacci')
        self.goal = None
        self.count = 0

    def send_goal(self):
        goal = Fibonacci.Goal()
        goal.order = 20
        self.client.send_goal_async(goal, self.on_feedback).add_done_callback(self.on_response)

    def on_response(self, future):
        self.goal = future.result()
        self.goal.get_result_async().add_done_callback(self.on_result)
        self.timer = self.create_timer(3.0, self.cancel_goal)

    def on_feedback(self, message):
        self.get_logger().info(f'Feedback: {list(message.feedback.partial_sequence)}')

    def on_result(self, future):
        status = future.result().status
        if status == GoalStatus.STATUS_CANCELED:
            self.get_logger().info('Goal was canceled')
        else:
            self.get_logger().info(f'Goal ended with status {status}')
        rclpy.shutdown()


    def cancel_goal(self):
        self.timer.cancel()
        self.get_logger().info('Timer triggered: Cancelling goal.')
        self.goal.cancel_goal_async()


def main():
    rclpy.init()
    node = CancelingClient()
    if not node.client.wait_for_server(timeout_sec=10.0):
        raise SystemExit('the action server is not available')
    node.send_goal()
    rclpy.spin(node)


if __name__ == '__main__':
    main()
