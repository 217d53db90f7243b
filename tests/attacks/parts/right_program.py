# The text of a program that does what Lab 1.1 asks for.
RIGHT_PROGRAM = """
import rclpy
from rclpy.node import Node


class SimpleNode(Node):
    def __init__(self):
        super().__init__("simple_node")
        self.get_logger().info("Hello, ROS 2! From SimpleNode.")


def main():
    rclpy.init()
    rclpy.spin(SimpleNode())
"""
