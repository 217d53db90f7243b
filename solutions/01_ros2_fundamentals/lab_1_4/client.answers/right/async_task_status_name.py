"""Right: a coroutine as a task; names the status."""
import sys
import time

import rclpy
from action_msgs.msg import GoalStatus
from my_robot_interfaces.action import Fibonacci
from rclpy.action import ActionClient
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node

NAMES = {getattr(GoalStatus, name): name.removeprefix('STATUS_') for name in dir(GoalStatus) if name.startswith('STATUS_')}


class Client(Node):
    def __init__(self):
        super().__init__('async_client')
        self.fib = ActionClient(self, Fibonacci, 'fibonacci')

    async def go(self, order):
        handle = await self.fib.send_goal_async(Fibonacci.Goal(order=order), feedback_callback=self.show)
        if not handle.accepted:
            self.get_logger().warning('rejected')
            return
        answer = await handle.get_result_async()
        self.get_logger().info(f'{NAMES[answer.status]} {answer.result.sequence}')

    def show(self, message):
        numbers = message.feedback.partial_sequence
        self.get_logger().info(f'{len(numbers)} numbers, the last is {numbers[-1]:_}')


def main():
    rclpy.init()
    node = Client()
    until = time.monotonic() + 5
    while not node.fib.server_is_ready():
        if time.monotonic() > until:
            node.get_logger().fatal('server not available')
            return
        time.sleep(0.02)
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    executor.spin_until_future_complete(executor.create_task(node.go, int(sys.argv[1])))
    rclpy.shutdown()


if __name__ == '__main__':
    main()
