"""Wrong: the timer that calls is never stopped."""
import sys

import rclpy
from my_robot_interfaces.srv import AddTwoInts
from rclpy.node import Node


class Polling(Node):
    def __init__(self, numbers):
        super().__init__('polling')
        self.numbers = numbers
        self.cli = self.create_client(AddTwoInts, 'add_two_ints')
        self.tries = 0
        self.create_timer(0.2, self.look)

    def look(self):
        self.tries += 1
        if self.cli.service_is_ready():
            self.ask(self.numbers[0], self.numbers[1], self.numbers[2:])
        elif self.tries > 30:
            sys.exit('add_two_ints is not available')

    def ask(self, a, b, rest):
        future = self.cli.call_async(AddTwoInts.Request(a=a, b=b))
        future.add_done_callback(lambda done: self.got(done.result().sum, rest))

    def got(self, total, rest):
        if rest:
            self.ask(total, rest[0], rest[1:])
            return
        self.get_logger().info(f'Final sum: {total}')
        sys.exit()


def main():
    rclpy.init()
    rclpy.spin(Polling([int(word) for word in sys.argv[1:]]))


if __name__ == '__main__':
    main()
