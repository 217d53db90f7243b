"""Right: no inheritance; a dataclass holds a plain Node, its publisher and the counter."""
from dataclasses import dataclass, field

import rclpy
from rclpy.node import Node
from rclpy.publisher import Publisher
from std_msgs.msg import String


@dataclass
class Talker:
    node: Node = field(default_factory=lambda: Node('composed'))
    said: int = 0
    publisher: Publisher = field(init=False)

    def __post_init__(self) -> None:
        self.publisher = self.node.create_publisher(String, 'chatter', 10)
        self.node.create_timer(0.5, self.say)

    def say(self) -> None:
        line = ' '.join(['Hello,', 'world!', str(self.said)])
        self.publisher.publish(String(data=line))
        self.node.get_logger().debug(line)
        self.said += 1


def main() -> None:
    rclpy.init()
    rclpy.spin(Talker().node)


if __name__ == '__main__':
    main()
