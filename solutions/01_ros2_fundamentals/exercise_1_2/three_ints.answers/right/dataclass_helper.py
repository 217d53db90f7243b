"""Right: a dataclass wraps node and client; the operands of the second call are the other way round; raises TimeoutError."""
import sys
from dataclasses import dataclass

import rclpy
from my_robot_interfaces.srv import AddTwoInts
from rclpy.client import Client
from rclpy.node import Node


@dataclass(frozen=True)
class Adder:
    node: Node
    client: Client

    @classmethod
    def connect(cls, patience_sec: float = 5.0) -> 'Adder':
        node = rclpy.create_node('adder')
        client = node.create_client(AddTwoInts, 'add_two_ints')
        if not client.wait_for_service(timeout_sec=patience_sec):
            raise TimeoutError(f'add_two_ints not available within {patience_sec} s')
        return cls(node, client)

    def add(self, a: int, b: int) -> int:
        future = self.client.call_async(AddTwoInts.Request(a=a, b=b))
        rclpy.spin_until_future_complete(self.node, future)
        return future.result().sum


def main() -> None:
    a, b, c = map(int, sys.argv[1:])
    rclpy.init()
    adder = Adder.connect()
    adder.node.get_logger().info(f'final sum: {adder.add(c, adder.add(a, b))}')


if __name__ == '__main__':
    main()
