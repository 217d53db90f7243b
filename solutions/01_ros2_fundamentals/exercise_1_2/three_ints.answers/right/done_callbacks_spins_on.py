"""Right: reports the sum and then spins until Ctrl-C, like the nodes before it; the task asks for no end."""
import sys

import rclpy
from my_robot_interfaces.srv import AddTwoInts


def main():
    a, b, c = [int(n) for n in sys.argv[1:4]]
    rclpy.init()
    node = rclpy.create_node('patient')
    client = node.create_client(AddTwoInts, 'add_two_ints')
    if not client.wait_for_service(5.0):
        raise SystemExit('add_two_ints service not available')

    def first(future):
        request = AddTwoInts.Request(a=future.result().sum, b=c)
        client.call_async(request).add_done_callback(
            lambda f: node.get_logger().info('sum = ' + str(f.result().sum))
        )

    client.call_async(AddTwoInts.Request(a=a, b=b)).add_done_callback(first)
    rclpy.spin(node)


if __name__ == '__main__':
    main()
