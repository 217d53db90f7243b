"""Wrong, row 1: no spin at all; the node is gone at once, and the program needs a while to end."""
import time

import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class TalkerNode(Node):
    def __init__(self):
        super().__init__('talker_node')
        self.pub = self.create_publisher(String, 'chatter', 10)
        self.i = 0
        self.timer = self.create_timer(0.5, self.timer_callback)

    def timer_callback(self):
        self.pub.publish(String(data=f'Hello, world! {self.i}'))
        self.i += 1


def main():
    rclpy.init()
    node = TalkerNode()
    time.sleep(0.5)
    node.destroy_node()
    rclpy.shutdown()
    time.sleep(6)


if __name__ == '__main__':
    main()
