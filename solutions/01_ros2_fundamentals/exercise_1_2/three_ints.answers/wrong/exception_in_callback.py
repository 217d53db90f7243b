"""Wrong, row 26: an exception in the done-callback of the second call, before the sum is said."""
import sys

import rclpy
from my_robot_interfaces.srv import AddTwoInts
from rclpy.node import Node


class ThreeInts(Node):
    def __init__(self):
        super().__init__('three_ints')
        self.cli = self.create_client(AddTwoInts, 'add_two_ints')
        self.sums = {}

    def ask(self, a, b, then):
        future = self.cli.call_async(AddTwoInts.Request(a=a, b=b))
        future.add_done_callback(lambda f: then(f.result().sum))

    def first(self, total):
        self.ask(total, int(sys.argv[3]), self.second)

    def second(self, total):
        self.get_logger().info('Final sum: ' + total)
        rclpy.shutdown()


def main():
    a, b, c = int(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3])
    rclpy.init()
    node = ThreeInts()
    if not node.cli.wait_for_service(timeout_sec=5.0):
        sys.exit('add_two_ints is not available')
    node.ask(a, b, node.first)
    rclpy.spin(node)


if __name__ == '__main__':
    main()
