"""Right: itertools calls the service for each sum."""
import sys
from itertools import accumulate
import rclpy
from my_robot_interfaces.srv import AddTwoInts
from rclpy.node import Node


class Asker(Node):
    def __init__(self):
        super().__init__('asker')
        self.cli = self.create_client(AddTwoInts, 'add_two_ints')

    def ask(self, a, b):
        future = self.cli.call_async(AddTwoInts.Request(a=a, b=b))
        rclpy.spin_until_future_complete(self, future, timeout_sec=5.0)
        return future.result().sum


def main():
    a, b, c = map(int, sys.argv[1:4])
    rclpy.init()
    node = Asker()
    if not node.cli.wait_for_service(timeout_sec=5.0):
        print('add_two_ints is not available')
        return
    *_, total = accumulate([a, b, c], node.ask)
    node.get_logger().info(f'Sum: {total}')


if __name__ == '__main__':
    main()
