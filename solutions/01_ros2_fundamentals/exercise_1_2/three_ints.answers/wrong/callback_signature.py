"""Wrong, row 8: a done-callback gets the future, this one takes no argument."""
import sys

import rclpy
from my_robot_interfaces.srv import AddTwoInts
from rclpy.node import Node


class ThreeInts(Node):
    def __init__(self):
        super().__init__('three_ints')
        self.cli = self.create_client(AddTwoInts, 'add_two_ints')

    def ask(self, a, b, then):
        self.future = self.cli.call_async(AddTwoInts.Request(a=a, b=b))
        self.future.add_done_callback(then)

    def first(self):
        self.ask(self.future.result().sum, int(sys.argv[3]), self.second)

    def second(self):
        self.get_logger().info(f'Final sum: {self.future.result().sum}')
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
