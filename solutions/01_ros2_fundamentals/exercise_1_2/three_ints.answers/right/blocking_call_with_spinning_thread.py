"""Right: the blocking call(), while a second thread spins; everything is shut down and joined."""
import sys
import threading

import rclpy
from my_robot_interfaces.srv import AddTwoInts
from rclpy.executors import SingleThreadedExecutor


def main():
    a, b, c = map(int, sys.argv[1:4])
    rclpy.init()
    node = rclpy.create_node('three_ints')
    client = node.create_client(AddTwoInts, '/add_two_ints')
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    spinner = threading.Thread(target=executor.spin)
    spinner.start()
    try:
        if not client.wait_for_service(timeout_sec=4.0):
            print('service not available: add_two_ints')
            return 1
        first = client.call(AddTwoInts.Request(a=a, b=b))
        second = client.call(AddTwoInts.Request(a=first.sum, b=c))
        print('%d + %d + %d = %d' % (a, b, c, second.sum))
        return 0
    finally:
        executor.shutdown()
        spinner.join()
        node.destroy_node()
        rclpy.shutdown()


if __name__ == '__main__':
    sys.exit(main())
