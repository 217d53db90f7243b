"""Right: counts in the feedback callback, cancels once at the third, done-callbacks for all the rest."""
import rclpy
from action_msgs.msg import GoalStatus
from my_robot_interfaces.action import Fibonacci
from rclpy.action import ActionClient
from rclpy.node import Node


class CancelingClient(Node):
    def __init__(self):
        super().__init__('canceling_client')
        self.client = ActionClient(self, Fibonacci, 'fibonacci')
        self.goal_handle = None
        self.feedbacks = 0

    def send_goal(self, order):
        future = self.client.send_goal_async(Fibonacci.Goal(order=order), feedback_callback=self.on_feedback)
        future.add_done_callback(self.on_response)

    def on_response(self, future):
        self.goal_handle = future.result()
        if not self.goal_handle.accepted:
            self.get_logger().error('Goal rejected')
            rclpy.shutdown()
            return
        self.goal_handle.get_result_async().add_done_callback(self.on_result)

    def on_feedback(self, message):
        self.feedbacks += 1
        self.get_logger().info(f'Feedback {list(message.feedback.partial_sequence)}')
        if self.feedbacks == 3:
            self.goal_handle.cancel_goal_async().add_done_callback(self.on_cancel)

    def on_cancel(self, future):
        self.get_logger().info(f'{len(future.result().goals_canceling)} goal is canceling')

    def on_result(self, future):
        status = future.result().status
        if status == GoalStatus.STATUS_CANCELED:
            self.get_logger().info('Final status: CANCELED')
        else:
            self.get_logger().warn(f'Final status: {status}')
        rclpy.shutdown()


def main(args=None):
    rclpy.init(args=args)
    node = CancelingClient()
    if not node.client.wait_for_server(timeout_sec=10.0):
        node.get_logger().error('action server not available')
        return
    node.send_goal(20)
    rclpy.spin(node)


if __name__ == '__main__':
    main()
