# Right: one line tells both ends: "service found, sum: 12", or "service not available, sum: None" where there is none after five seconds.
import sys
from typing import NamedTuple

import rclpy
from my_robot_interfaces.srv import AddTwoInts


class Outcome(NamedTuple):
    found: bool
    total: int | None


def ask(node, a: int, b: int, patience_sec: float) -> Outcome:
    client = node.create_client(AddTwoInts, 'add_two_ints')
    if not client.wait_for_service(timeout_sec=patience_sec):
        return Outcome(False, None)
    future = client.call_async(AddTwoInts.Request(a=a, b=b))
    rclpy.spin_until_future_complete(node, future)
    return Outcome(True, future.result().sum)


def main() -> None:
    a, b = (int(word) for word in sys.argv[1:])
    rclpy.init()
    node = rclpy.create_node('add_two_ints_client')
    outcome = ask(node, a, b, patience_sec=5.0)
    node.get_logger().info(f'service {"found" if outcome.found else "not available"}, sum: {outcome.total}')
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
