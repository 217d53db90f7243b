"""Right: no guard, because setup.py names main() as a console script; run that way (see expected.toml)."""
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


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(TalkerNode())
