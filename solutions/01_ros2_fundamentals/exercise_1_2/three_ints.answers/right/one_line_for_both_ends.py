# Right: a dataclass tells both ends in one line: "Outcome(service='found', total=6)", or "Outcome(service='not available', total=None)" where there is none after five seconds.
import sys
from dataclasses import dataclass

import rclpy
from my_robot_interfaces.srv import AddTwoInts


@dataclass
class Outcome:
    service: str = 'not available'
    total: int | None = None


def add_three_ints(node, a, b, c, patience_sec=5.0):
    client = node.create_client(AddTwoInts, 'add_two_ints')
    outcome = Outcome()
    if client.wait_for_service(timeout_sec=patience_sec):
        outcome.service = 'found'
        outcome.total = a
        for number in (b, c):
            future = client.call_async(AddTwoInts.Request(a=outcome.total, b=number))
            rclpy.spin_until_future_complete(node, future)
            outcome.total = future.result().sum
    return outcome


def main():
    rclpy.init()
    node = rclpy.create_node('add_three_ints_client')
    print(add_three_ints(node, *map(int, sys.argv[1:])))
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
