"""Right: a timer says that nothing has come yet, and a count after every fifth text, in the words of each text."""
import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class Listener(Node):
    def __init__(self):
        super().__init__('listener')
        self.count = 0
        self.create_subscription(String, 'chatter', self.callback, 10)
        self.create_timer(0.5, self.status)

    def callback(self, msg):
        self.count += 1
        self.get_logger().info(f'I heard: {msg.data}')
        if self.count % 5 == 0:
            self.get_logger().info(f'I heard: {self.count} messages so far')

    def status(self):
        if not self.count:
            self.get_logger().info('I heard: nothing yet')


def main():
    rclpy.init()
    rclpy.spin(Listener())


if __name__ == '__main__':
    main()
