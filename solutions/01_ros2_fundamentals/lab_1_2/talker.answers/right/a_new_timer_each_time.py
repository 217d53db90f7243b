"""Right: each tick makes the timer of the next one."""
import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class Talker(Node):
    def __init__(self):
        super().__init__('talker')
        self.pub = self.create_publisher(String, 'chatter', 10)
        self.timer = self.create_timer(0.5, self.tick)
        self.i = 0

    def tick(self):
        msg = String()
        msg.data = f'Hello, world! {self.i}'
        self.pub.publish(msg)
        self.get_logger().info(msg.data)
        self.i += 1
        self.destroy_timer(self.timer)
        self.timer = self.create_timer(0.5, self.tick)


def main():
    rclpy.init()
    rclpy.spin(Talker())


if __name__ == '__main__':
    main()
