"""Wrong, row 9: the method is called instead of handed over as the timer's callback."""
import sys

import rclpy
from my_robot_interfaces.srv import AddTwoInts
from rclpy.node import Node


class ThreeInts(Node):
    def __init__(self):
        super().__init__('three_ints')
        self.cli = self.create_client(AddTwoInts, 'add_two_ints')
        self.numbers = []
        self.create_timer(0.1, self.work())

    def work(self):
        if len(self.numbers) > 1:
            a, b = self.numbers.pop(0), self.numbers.pop(0)
            self.cli.call_async(AddTwoInts.Request(a=a, b=b)).add_done_callback(self.answered)

    def answered(self, future):
        self.numbers.insert(0, future.result().sum)
        if len(self.numbers) == 1:
            self.get_logger().info(f'Final sum: {self.numbers[0]}')
            rclpy.shutdown()


def main():
    a, b, c = int(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3])
    rclpy.init()
    node = ThreeInts()
    if not node.cli.wait_for_service(timeout_sec=5.0):
        sys.exit('add_two_ints is not available')
    node.numbers = [a, b, c]
    rclpy.spin(node)


if __name__ == '__main__':
    main()
