"""Wrong, row 40: rclpy cannot look at the arguments of a builtin such as deque.append."""
from collections import deque

import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class ListenerNode(Node):
    def __init__(self):
        super().__init__('listener_node')
        self.texts = deque(maxlen=100)
        self.create_subscription(String, 'chatter', self.texts.append, 10)
        self.create_timer(0.1, self.log_all)

    def log_all(self):
        while self.texts:
            self.get_logger().info(self.texts.popleft().data)


def main(args=None):
    rclpy.init(args=args)
    node = ListenerNode()
    rclpy.spin(node)


if __name__ == '__main__':
    main()
