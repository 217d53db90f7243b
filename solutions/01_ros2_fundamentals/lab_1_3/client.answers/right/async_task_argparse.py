"""Right: a coroutine as a task of the executor; argparse reads the numbers."""
import argparse

import rclpy
from my_robot_interfaces.srv import AddTwoInts
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node


async def add(client, a, b):
    return (await client.call_async(AddTwoInts.Request(a=a, b=b))).sum


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument('a', type=int)
    parser.add_argument('b', type=int)
    given = parser.parse_args()
    rclpy.init()
    try:
        node = Node('adding')
        client = node.create_client(AddTwoInts, 'add_two_ints')
        if not client.wait_for_service(3.0):
            raise TimeoutError('add_two_ints not available within 3 s')
        executor = SingleThreadedExecutor()
        executor.add_node(node)
        task = executor.create_task(add, client, given.a, given.b)
        executor.spin_until_future_complete(task)
        print(f'{given.a}\t{given.b}\t{task.result()}')
    finally:
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
