"""Right: a coroutine that awaits both calls, run with executor.create_task; argparse reads the numbers."""
import argparse

import rclpy
from my_robot_interfaces.srv import AddTwoInts
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node


async def add_three(node, client, a, b, c):
    first = await client.call_async(AddTwoInts.Request(a=a, b=b))
    second = await client.call_async(AddTwoInts.Request(a=first.sum, b=c))
    node.get_logger().info('The sum is {}.'.format(second.sum))


def main():
    parser = argparse.ArgumentParser(description='Add three integers with two service calls.')
    for name in 'abc':
        parser.add_argument(name, type=int)
    numbers = vars(parser.parse_args())

    rclpy.init()
    node = Node('async_client')
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    client = node.create_client(AddTwoInts, 'add_two_ints')
    if not client.wait_for_service(timeout_sec=5.0):
        node.get_logger().error('service not available')
    else:
        executor.spin_until_future_complete(executor.create_task(add_three(node, client, **numbers)))
    rclpy.shutdown()


if __name__ == '__main__':
    main()
