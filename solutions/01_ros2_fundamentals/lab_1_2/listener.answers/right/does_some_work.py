"""Right: works for a fifth of a second on each text."""
import time

import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class ListenerNode(Node):
    def __init__(self):
        super().__init__('listener_node')
        self.create_subscription(String, 'chatter', self.listener_callback, 10)

    def listener_callback(self, msg):
        time.sleep(0.2)
        self.get_logger().info(f'I heard: "{msg.data}"')


def main():
    rclpy.init()
    rclpy.spin(ListenerNode())


if __name__ == '__main__':
    main()
