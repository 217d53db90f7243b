"""Right: a loop of spin_once until the future is done."""
import sys

import rclpy
from my_robot_interfaces.srv import AddTwoInts


def main(a, b):
    rclpy.init()
    node = rclpy.create_node('looping_client')
    log = node.get_logger()
    client = node.create_client(AddTwoInts, 'add_two_ints')
    for _ in range(50):
        if client.service_is_ready():
            break
        rclpy.spin_once(node, timeout_sec=0.1)
    else:
        log.fatal('⏳ add_two_ints not available')
        return 1
    request = AddTwoInts.Request()
    request.a, request.b = a, b
    future = client.call_async(request)
    while not future.done():
        rclpy.spin_once(node)
    log.warning('➕ %d' % future.result().sum)
    rclpy.shutdown()
    return 0


if __name__ == '__main__':
    sys.exit(main(*map(int, sys.argv[1:])))
