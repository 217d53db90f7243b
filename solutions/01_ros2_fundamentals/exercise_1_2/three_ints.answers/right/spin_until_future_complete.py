"""Right: the course text's class with call_async and spin_until_future_complete, arguments first, a limit on waiting."""
import sys

import rclpy
from my_robot_interfaces.srv import AddTwoInts
from rclpy.node import Node


class AddThreeIntsClient(Node):
    def __init__(self):
        super().__init__('add_three_ints_client')
        self.cli = self.create_client(AddTwoInts, 'add_two_ints')

    def add(self, a, b):
        request = AddTwoInts.Request()
        request.a = a
        request.b = b
        self.get_logger().info(f'Requesting sum of {a} and {b}...')
        future = self.cli.call_async(request)
        rclpy.spin_until_future_complete(self, future)
        return future.result().sum


def main(args=None):
    if len(sys.argv) != 4:
        print('Usage: add_three_ints_client <int> <int> <int>')
        return
    a, b, c = (int(word) for word in sys.argv[1:4])

    rclpy.init(args=args)
    client = AddThreeIntsClient()
    if client.cli.wait_for_service(timeout_sec=5.0):
        total = client.add(client.add(a, b), c)
        client.get_logger().info(f'Final sum of {a}, {b}, and {c}: {total}')
    else:
        client.get_logger().error('add_two_ints is not available, giving up')
    client.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
