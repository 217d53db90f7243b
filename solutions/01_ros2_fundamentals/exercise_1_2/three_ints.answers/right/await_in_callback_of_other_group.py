"""Right: an async timer callback awaits both calls; the client is in a reentrant group, so the answers get through."""
import sys

import rclpy
from my_robot_interfaces.srv import AddTwoInts
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.node import Node


class AwaitingClient(Node):
    def __init__(self, numbers):
        super().__init__('awaiting_client')
        self.numbers = numbers
        self.client = self.create_client(AddTwoInts, 'add_two_ints', callback_group=ReentrantCallbackGroup())
        self.create_timer(0.05, self.work)
        self.busy = self.finished = False

    async def work(self):
        if self.busy:
            return
        self.busy = True
        total = self.numbers[0]
        for number in self.numbers[1:]:
            total = (await self.client.call_async(AddTwoInts.Request(a=total, b=number))).sum
        self.get_logger().info('=> %d' % total)
        self.finished = True


def main():
    numbers = [int(n) for n in sys.argv[1:4]]
    rclpy.init()
    node = AwaitingClient(numbers)
    if not node.client.wait_for_service(timeout_sec=4.5):
        print('waited 4.5 s in vain: add_two_ints not available', file=sys.stderr)
        return
    while not node.finished:
        rclpy.spin_once(node)


if __name__ == '__main__':
    main()
