"""Wrong: the stub as it was handed out."""
import sys

import rclpy
from my_robot_interfaces.srv import AddTwoInts
from rclpy.node import Node


class ThreeInts(Node):
    def __init__(self):
        super().__init__('three_ints')
        # TODO: create the client

    # TODO: a method that calls the service


def main():
    rclpy.init()
    node = ThreeInts()
    # TODO: read the numbers, call the service twice, say the sum
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
