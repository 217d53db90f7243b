"""Right: the sum stands behind an ellipsis, in the line that it began before the call."""
import sys

import rclpy
from my_robot_interfaces.srv import AddTwoInts
from rclpy.node import Node


def main():
    rclpy.init()
    node = Node('asking')
    client = node.create_client(AddTwoInts, 'add_two_ints')
    if not client.wait_for_service(timeout_sec=5.0):
        node.get_logger().error('the service add_two_ints is not available')
        raise SystemExit(1)
    request = AddTwoInts.Request(a=int(sys.argv[1]), b=int(sys.argv[2]))
    print('asking for the sum...', end='', flush=True)
    future = client.call_async(request)
    rclpy.spin_until_future_complete(node, future, timeout_sec=5.0)
    print(future.result().sum if future.done() else 'no answer')
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
