"""Wrong: waits in the feedback callback for the answer to its cancel request; the wait outside gets nothing more."""
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

    def on_feedback(self, message):
        self.feedbacks += 1
        if self.feedbacks == 3:
            wait_for(self, self.goal_handle.cancel_goal_async(), 5.0)


def wait_for(node, future, patience):
    rclpy.spin_until_future_complete(node, future, timeout_sec=patience)
    if not future.done():
        raise TimeoutError(f'no answer within {patience} s')
    return future.result()


def main():
    rclpy.init()
    node = CancelingClient()
    if not node.client.wait_for_server(timeout_sec=10.0):
        raise RuntimeError('action server not available')
    sending = node.client.send_goal_async(Fibonacci.Goal(order=20), feedback_callback=node.on_feedback)
    node.goal_handle = wait_for(node, sending, 5.0)
    if not node.goal_handle.accepted:
        raise RuntimeError('the goal was rejected')
    answer = wait_for(node, node.goal_handle.get_result_async(), 15.0)
    names = {GoalStatus.STATUS_SUCCEEDED: 'SUCCEEDED', GoalStatus.STATUS_CANCELED: 'CANCELED', GoalStatus.STATUS_ABORTED: 'ABORTED'}
    node.get_logger().info(names[answer.status])


if __name__ == '__main__':
    main()
