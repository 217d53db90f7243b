"""Right: raises exceptions of its own for all that went wrong."""
import argparse

import rclpy
from action_msgs.msg import GoalStatus
from my_robot_interfaces.action import Fibonacci
from rclpy.action import ActionClient
from rclpy.node import Node


class GoalFailed(RuntimeError):
    pass


def fibonacci(node, order):
    client = ActionClient(node, Fibonacci, 'fibonacci')
    if not client.wait_for_server(timeout_sec=3.0):
        raise TimeoutError('fibonacci not available within 3 s')
    log = node.get_logger()
    sending = client.send_goal_async(
        Fibonacci.Goal(order=order), lambda m: log.info(f'+ {m.feedback.partial_sequence[-1]}')
    )
    rclpy.spin_until_future_complete(node, sending)
    if not sending.result().accepted:
        raise GoalFailed('rejected: not accepted')
    waiting = sending.result().get_result_async()
    rclpy.spin_until_future_complete(node, waiting)
    if waiting.result().status != GoalStatus.STATUS_SUCCEEDED:
        raise GoalFailed(f'status {waiting.result().status}')
    return waiting.result().result.sequence


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument('order', type=int)
    order = parser.parse_args().order
    rclpy.init()
    try:
        print(fibonacci(Node('fibonacci_client'), order))
    finally:
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
