"""Wrong: the course text's client with what real Jazzy needs; its timer cancels once, after 1.8 s."""
import rclpy
from action_msgs.msg import GoalStatus
from rclpy.action import ActionClient
from rclpy.node import Node
from my_robot_interfaces.action import Fibonacci


class FibonacciActionClient(Node):
    def __init__(self):
        super().__init__('fibonacci_action_client')
        self._action_client = ActionClient(self, Fibonacci, 'fibonacci')
        self.get_logger().info('Fibonacci action client ready.')
        self.goal_handle = None
        self.cancellation_timer = None

    def send_goal(self, order):
        self.get_logger().info('Waiting for action server...')
        self._action_client.wait_for_server()
        goal_msg = Fibonacci.Goal()
        goal_msg.order = order
        self.get_logger().info(f'Sending goal request... order={order}')
        self._send_goal_future = self._action_client.send_goal_async(
            goal_msg,
            feedback_callback=self.feedback_callback
        )
        self._send_goal_future.add_done_callback(self.goal_response_callback)

    def goal_response_callback(self, future):
        self.goal_handle = future.result()
        if not self.goal_handle.accepted:
            self.get_logger().error('Goal rejected :(')
            rclpy.shutdown()
            return
        self.get_logger().info('Goal accepted :)')
        self.cancellation_timer = self.create_timer(1.8, self.cancel_goal_timer_callback)
        self._get_result_future = self.goal_handle.get_result_async()
        self._get_result_future.add_done_callback(self.get_result_callback)

    def get_result_callback(self, future):
        status = future.result().status
        if status == GoalStatus.STATUS_SUCCEEDED:
            result = future.result().result
            self.get_logger().info(f'Goal succeeded! Result: {list(result.sequence)}')
        elif status == GoalStatus.STATUS_CANCELED:
            self.get_logger().info('Goal was successfully canceled.')
        else:
            self.get_logger().warn(f'Goal finished with status: {status}')
        rclpy.shutdown()

    def feedback_callback(self, feedback_msg):
        self.get_logger().info(f'Received feedback: {list(feedback_msg.feedback.partial_sequence)}')

    def cancel_goal_timer_callback(self):
        self.cancellation_timer.cancel()
        self.get_logger().info('Timer triggered: Cancelling goal.')
        self.goal_handle.cancel_goal_async()


def main(args=None):
    rclpy.init(args=args)
    action_client = FibonacciActionClient()
    action_client.send_goal(20)
    rclpy.spin(action_client)


if __name__ == '__main__':
    main()
