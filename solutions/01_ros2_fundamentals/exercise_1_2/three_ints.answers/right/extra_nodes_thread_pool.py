"""Right: with-statements, a thread pool, a second node with a topic of its own, progress lines in between."""
import sys
from concurrent.futures import ThreadPoolExecutor

import rclpy
from my_robot_interfaces.srv import AddTwoInts
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import Int64


def add_three(client, a, b, c):
    if not client.wait_for_service(timeout_sec=5.0):
        return None
    ask = lambda x, y: client.call(AddTwoInts.Request(a=x, b=y)).sum
    return ask(ask(a, b), c)


def main():
    numbers = list(map(int, sys.argv[1:4]))
    rclpy.init()
    node, reporter = Node('three_ints'), Node('reporter')
    publisher = reporter.create_publisher(Int64, 'sum', 1)
    client = node.create_client(AddTwoInts, 'add_two_ints')
    with MultiThreadedExecutor() as executor, ThreadPoolExecutor(1) as pool:
        executor.add_node(node)
        executor.add_node(reporter)
        job = pool.submit(add_three, client, *numbers)
        while not job.done():
            executor.spin_once(timeout_sec=0.05)
        total = job.result()
    if total is None:
        print('add_two_ints: NOT AVAILABLE.')
    else:
        publisher.publish(Int64(data=total))
        reporter.get_logger().info(f'numbers: {numbers}')
        reporter.get_logger().info(f'sum: {total}')
    rclpy.shutdown()


if __name__ == '__main__':
    main()
