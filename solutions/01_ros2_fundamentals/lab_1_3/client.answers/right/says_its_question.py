"""Right: says what it wants to know before it waits, and gives up aloud."""
import sys

import rclpy
from my_robot_interfaces.srv import AddTwoInts


def main():
    a, b = int(sys.argv[1]), int(sys.argv[2])
    rclpy.init()
    node = rclpy.create_node('add_two_ints_client')
    client = node.create_client(AddTwoInts, 'add_two_ints')
    node.get_logger().info(f'I want to know what {a} + {b} is')
    if not client.wait_for_service(timeout_sec=5.0):
        node.get_logger().error(f'cannot add {a} and {b}: the service add_two_ints is not available')
        rclpy.shutdown()
        sys.exit(1)
    future = client.call_async(AddTwoInts.Request(a=a, b=b))
    rclpy.spin_until_future_complete(node, future, timeout_sec=5.0)
    if future.done():
        node.get_logger().info(f'the service says: {future.result().sum}')
    else:
        node.get_logger().error('no answer')
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
