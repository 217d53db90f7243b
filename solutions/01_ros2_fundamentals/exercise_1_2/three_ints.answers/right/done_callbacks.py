"""Right: the first answer's done-callback makes the second call, the second one's callback ends the spin."""
import sys
from functools import partial

import rclpy
from my_robot_interfaces.srv import AddTwoInts
from rclpy.node import Node
from rclpy.task import Future


class ChainedClient(Node):
    def __init__(self, a, b, c):
        super().__init__('chained_client')
        self.finished = Future()
        self.client = self.create_client(AddTwoInts, 'add_two_ints')
        self.numbers = (a, b, c)

    def start(self):
        a, b, c = self.numbers
        self.client.call_async(AddTwoInts.Request(a=a, b=b)).add_done_callback(partial(self.got_first, c))

    def got_first(self, c, future):
        between = future.result().sum
        self.get_logger().info(f'in between: {between}')
        self.client.call_async(AddTwoInts.Request(a=between, b=c)).add_done_callback(self.got_second)

    def got_second(self, future):
        self.get_logger().info(f'altogether: {future.result().sum}')
        self.finished.set_result(True)


def main(args=None):
    rclpy.init(args=args)
    node = ChainedClient(*(int(s) for s in sys.argv[1:]))
    if not node.client.wait_for_service(timeout_sec=5):
        node.get_logger().fatal('the service was not available within 5 s')
        return
    node.start()
    rclpy.spin_until_future_complete(node, node.finished)


if __name__ == '__main__':
    main()
