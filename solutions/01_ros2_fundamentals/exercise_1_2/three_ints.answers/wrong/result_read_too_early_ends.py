"""Wrong: sends the first request and ends; the done-callback never gets its turn."""
import sys

import rclpy
from my_robot_interfaces.srv import AddTwoInts
from rclpy.node import Node


class ThreeInts(Node):
    def __init__(self):
        super().__init__('three_ints')
        self.cli = self.create_client(AddTwoInts, 'add_two_ints')

    def ask(self, a, b, then):
        self.cli.call_async(AddTwoInts.Request(a=a, b=b)).add_done_callback(lambda f: then(f.result().sum))


def main():
    a, b, c = int(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3])
    rclpy.init()
    node = ThreeInts()
    if not node.cli.wait_for_service(timeout_sec=5.0):
        sys.exit('add_two_ints is not available')
    node.ask(a, b, lambda first: node.ask(first, c, print))
    rclpy.spin_once(node, timeout_sec=0.0)
    rclpy.shutdown()


if __name__ == '__main__':
    main()
