"""Right: spins until a future is done that nobody ends."""
import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class Listener(Node):
    def __init__(self):
        super().__init__('listener')
        self.create_subscription(String, 'chatter', self.heard, 10)

    def heard(self, msg):
        self.get_logger().info('I heard: "%s"' % msg.data)


def main():
    rclpy.init()
    node = Listener()
    rclpy.spin_until_future_complete(node, rclpy.task.Future())


if __name__ == '__main__':
    main()
