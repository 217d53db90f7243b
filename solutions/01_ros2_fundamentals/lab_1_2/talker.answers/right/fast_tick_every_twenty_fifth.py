"""Right: a 0.02 s timer that publishes at every twenty-fifth tick."""
import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class Talker(Node):
    def __init__(self):
        super().__init__('talker_node')
        self.pub = self.create_publisher(String, 'chatter', 10)
        self.ticks = 0
        self.create_timer(0.02, self.tick)

    def tick(self):
        self.ticks += 1
        if self.ticks % 25 == 0:
            self.pub.publish(String(data=f'Hello, world! {self.ticks // 25 - 1}'))


def main():
    rclpy.init()
    rclpy.spin(Talker())


if __name__ == '__main__':
    main()
