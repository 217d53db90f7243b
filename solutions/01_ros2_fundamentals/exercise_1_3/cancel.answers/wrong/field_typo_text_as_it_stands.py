"""Wrong, row 14: the course text's own client with the interface package's name adapted; the first feedback ends it."""
import rclpy
from rclpy.action import ActionClient
from rclpy.node import Node
from my_robot_interfaces.action import Fibonacci
from rclpy.task import Future
import threading
import time  # For simulating a delay before cancellation


class FibonacciActionClient(Node):
    def __init__(self):
        super().__init__('fibonacci_action_client')
        self._action_client = ActionClient(self, Fibonacci, 'fibonacci')
        self.get_logger().info('Fibonacci action client ready.')
        self.goal_handle = None
        self.feedback_count = 0
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
        # Start a timer to cancel the goal after some feedback
        self.cancellation_timer = self.create_timer(3.0, self.cancel_goal_timer_callback)  # Cancel after 3 seconds

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

        if self.cancellation_timer:
            self.cancellation_timer.cancel()
        rclpy.shutdown()

    def feedback_callback(self, feedback_msg):
        self.get_logger().info(f'Received feedback: {list(feedback_msg.partial_sequence)}')
        self.feedback_count += 1
        # Optional: Cancel after N feedback messages
        # if self.feedback_count >= 3 and self.goal_handle and not self.goal_handle.is_status_done():
        #     self.get_logger().info('Cancelling goal after sufficient feedback.')
        #     cancel_future = self.goal_handle.cancel_goal_async()
        #     cancel_future.add_done_callback(
        #         lambda future: self.get_logger().info(f'Goal cancellation request sent: {future.result().return_code}')
        #     )

    def cancel_goal_timer_callback(self):
        if self.goal_handle and not self.goal_handle.is_status_done():
            self.get_logger().info('Timer triggered: Cancelling goal.')
            cancel_future = self.goal_handle.cancel_goal_async()
            cancel_future.add_done_callback(
                lambda future: self.get_logger().info(f'Goal cancellation request sent: {future.result().return_code}')
            )
        else:
            if self.cancellation_timer:
                self.cancellation_timer.cancel()  # Stop the timer if goal is already done


def main(args=None):
    rclpy.init(args=args)
    action_client = FibonacciActionClient()
    action_client.send_goal(20)  # Request Fibonacci sequence up to order 20
    rclpy.spin(action_client)


if __name__ == '__main__':
    main()
