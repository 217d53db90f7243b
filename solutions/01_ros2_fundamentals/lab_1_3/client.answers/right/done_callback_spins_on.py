"""Right: a done-callback logs the sum, and the program spins on."""
import sys
import time

import rclpy
from my_robot_interfaces.srv import AddTwoInts
from rclpy.node import Node


class Client(Node):
    def __init__(self, a, b):
        super().__init__('client')
        self.numbers = AddTwoInts.Request(a=a, b=b)
        self.client = self.create_client(AddTwoInts, 'add_two_ints')
        self.until = time.monotonic() + 5.0
        self.timer = self.create_timer(0.05, self.try_it)

    def try_it(self):
        if self.client.service_is_ready():
            self.timer.cancel()
            self.client.call_async(self.numbers).add_done_callback(self.got_it)
        elif time.monotonic() > self.until:
            self.get_logger().error('add_two_ints is not available')
            raise SystemExit(1)

    def got_it(self, future):
        self.get_logger().info(f'The sum is {future.result().sum:,}.')


def main():
    rclpy.init()
    rclpy.spin(Client(*[int(text) for text in sys.argv[1:]]))


if __name__ == '__main__':
    main()
