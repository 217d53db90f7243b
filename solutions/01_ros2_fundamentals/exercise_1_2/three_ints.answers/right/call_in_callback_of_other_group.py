"""Right: call() inside a timer callback, with the client in a group of its own and several threads."""
import sys

import rclpy
from my_robot_interfaces.srv import AddTwoInts
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node


class GroupedClient(Node):
    def __init__(self, a, b, c):
        super().__init__('grouped_client')
        self.numbers = a, b, c
        self.done = False
        self.client = self.create_client(
            AddTwoInts, 'add_two_ints', callback_group=MutuallyExclusiveCallbackGroup()
        )
        self.once = self.create_timer(0.01, self.work)

    def work(self):
        self.once.cancel()
        a, b, c = self.numbers
        if self.client.wait_for_service(timeout_sec=5.0):
            total = self.client.call(AddTwoInts.Request(a=a, b=b)).sum
            total = self.client.call(AddTwoInts.Request(a=total, b=c)).sum
            self.get_logger().info(f'{a=} {b=} {c=} {total=}')
        else:
            self.get_logger().warning('service not available, no sum')
        self.done = True


def main():
    rclpy.init()
    node = GroupedClient(*map(int, sys.argv[1:]))
    executor = MultiThreadedExecutor(num_threads=2)
    executor.add_node(node)
    while not node.done:
        executor.spin_once(timeout_sec=0.1)
    executor.shutdown()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
