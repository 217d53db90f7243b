"""Right: a timer looks whether the service is ready and counts its tries; the node ends the program with SystemExit."""
import sys

import rclpy
from my_robot_interfaces.srv import AddTwoInts
from rclpy.node import Node


class PollingClient(Node):
    TRIES = 30

    def __init__(self, numbers):
        super().__init__('polling_client')
        self.total, *self.rest = numbers
        self.client = self.create_client(AddTwoInts, 'add_two_ints')
        self.tries = 0
        self.poll = self.create_timer(0.2, self.look)

    def look(self):
        self.tries += 1
        if self.client.service_is_ready():
            self.poll.cancel()
            self.next_call()
        elif self.tries > self.TRIES:
            self.get_logger().error('add_two_ints: not available')
            raise SystemExit(1)

    def next_call(self):
        if not self.rest:
            self.get_logger().info(f'Sum: {self.total}')
            raise SystemExit(0)
        request = AddTwoInts.Request(a=self.total, b=self.rest.pop(0))
        self.client.call_async(request).add_done_callback(self.answered)

    def answered(self, future):
        self.total = future.result().sum
        self.next_call()


def main():
    rclpy.init()
    rclpy.spin(PollingClient([int(n) for n in sys.argv[1:4]]))


if __name__ == '__main__':
    main()
