"""Wrong, row 22: the nested spin gives up after its limit and there is no answer to read."""
import sys

import rclpy
from my_robot_interfaces.srv import AddTwoInts
from rclpy.node import Node


class ThreeInts(Node):
    def __init__(self):
        super().__init__('three_ints')
        self.cli = self.create_client(AddTwoInts, 'add_two_ints')
        self.once = self.create_timer(0.1, self.work)

    def add(self, a, b):
        request = AddTwoInts.Request()
        request.a = a
        request.b = b
        future = self.cli.call_async(request)
        rclpy.spin_until_future_complete(self, future, timeout_sec=1.0)
        return future.result().sum

    def work(self):
        self.once.cancel()
        a, b, c = map(int, sys.argv[1:4])
        total = self.add(a, b)
        total = self.add(total, c)
        self.get_logger().info(f'Final sum: {total}')


def main():
    rclpy.init()
    node = ThreeInts()
    if not node.cli.wait_for_service(timeout_sec=5.0):
        sys.exit('add_two_ints is not available')
    rclpy.spin(node)


if __name__ == '__main__':
    main()
