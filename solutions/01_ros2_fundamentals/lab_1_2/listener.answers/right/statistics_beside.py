"""Right: a dataclass keeps count; every text is followed by a line with its length and the running total."""
from dataclasses import dataclass

import rclpy
from rclpy.node import Node
from std_msgs.msg import String


@dataclass
class Tally:
    texts: int = 0
    characters: int = 0

    def add(self, text: str) -> str:
        self.texts += 1
        self.characters += len(text)
        return f'{self.texts} texts, {self.characters} characters so far'


class CountingListener(Node):
    def __init__(self):
        super().__init__('counting_listener')
        self.tally = Tally()
        self.create_subscription(String, 'chatter', self.heard, 10)
        self.get_logger().info('waiting on chatter ...')

    def heard(self, msg):
        self.get_logger().info(msg.data)
        self.get_logger().info(self.tally.add(msg.data))


if __name__ == '__main__':
    rclpy.init()
    rclpy.spin(CountingListener())
