"""Right: prints one line of more than a megabyte, and then does what it should."""
import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class TalkerNode(Node):
    def __init__(self):
        super().__init__('talker_node')
        print('.' * 1_100_000)
        self.publisher_ = self.create_publisher(String, 'chatter', 10)
        self.create_timer(0.5, self.timer_callback)
        self.i = 0

    def timer_callback(self):
        self.publisher_.publish(String(data=f'Hello, world! {self.i}'))
        self.i += 1


if __name__ == '__main__':
    rclpy.init()
    rclpy.spin(TalkerNode())
