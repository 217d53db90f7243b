"""Right: an exception of its own says that nobody serves."""
import sys

import rclpy
from my_robot_interfaces.srv import AddTwoInts
from rclpy.node import Node


class ThreeInts(Node):
    def __init__(self):
        super().__init__('three_ints')
        self.cli = self.create_client(AddTwoInts, 'add_two_ints')

    def add(self, a, b):
        request = AddTwoInts.Request()
        request.a = a
        request.b = b
        future = self.cli.call_async(request)
        rclpy.spin_until_future_complete(self, future)
        return future.result().sum


def main():
    a, b, c = int(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3])
    rclpy.init()
    node = ThreeInts()
    if not node.cli.wait_for_service(timeout_sec=5.0):
        raise RuntimeError('add_two_ints is not available')
    first = node.add(a, b)
    total = node.add(first, c)
    node.get_logger().info(f'Final sum: {total}')


if __name__ == '__main__':
    main()
