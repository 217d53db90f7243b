"""Wrong: sleeps for two seconds in the main thread instead of counting messages."""
import threading
import time

import rclpy
from action_msgs.msg import GoalStatus
from my_robot_interfaces.action import Fibonacci
from rclpy.action import ActionClient
from rclpy.node import Node


def until_done(future):
    while not future.done():
        time.sleep(0.05)
    return future.result()


def main():
    rclpy.init()
    node = Node('sleeping_client')
    client = ActionClient(node, Fibonacci, 'fibonacci')
    threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()
    client.wait_for_server(timeout_sec=10.0)

    goal_handle = until_done(client.send_goal_async(Fibonacci.Goal(order=20)))
    if not goal_handle.accepted:
        raise SystemExit('the goal was rejected')
    node.get_logger().info('goal accepted, going to sleep')
    time.sleep(2.0)
    node.get_logger().info('requesting cancel')
    until_done(goal_handle.cancel_goal_async())

    status = until_done(goal_handle.get_result_async()).status
    text = 'canceled' if status == GoalStatus.STATUS_CANCELED else f'status {status}'
    node.get_logger().info(f'the goal ended: {text}')
    rclpy.shutdown()


if __name__ == '__main__':
    main()
