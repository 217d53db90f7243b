"""Wrong: the stub as it was handed out."""
import rclpy
from my_robot_interfaces.action import Fibonacci
from rclpy.node import Node


class CancelingClient(Node):
    def __init__(self):
        super().__init__('canceling_client')
        # TODO: create an ActionClient for 'fibonacci'


def main():
    rclpy.init()
    node = CancelingClient()
    # TODO: send a goal of order 20, cancel it after 3 to 5 feedback messages, say the final status
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
