"""Right: the plain client."""
import sys

import rclpy
from my_robot_interfaces.srv import AddTwoInts
from rclpy.node import Node


class AddTwoIntsClient(Node):
    def __init__(self):
        super().__init__('add_two_ints_client')
        self.cli = self.create_client(AddTwoInts, 'add_two_ints')

    def ask(self, a, b):
        request = AddTwoInts.Request()
        request.a = a
        request.b = b
        future = self.cli.call_async(request)
        rclpy.spin_until_future_complete(self, future)
        return future.result().sum


def main():
    a, b = int(sys.argv[1]), int(sys.argv[2])
    rclpy.init()
    node = AddTwoIntsClient()
    if not node.cli.wait_for_service(timeout_sec=5.0):
        sys.exit('add_two_ints is not available')
    node.get_logger().info(f'{a} + {b} = {node.ask(a, b)}')
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
