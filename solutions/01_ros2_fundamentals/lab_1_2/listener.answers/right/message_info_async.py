"""Right: an async callback with two arguments, the second one is the message's info."""
import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class InfoListener(Node):
    def __init__(self):
        super().__init__('info_listener')
        self.create_subscription(String, 'chatter', self.callback, 10)

    async def callback(self, msg, info):
        age_ms = (info['received_timestamp'] - info['source_timestamp']) / 1e6
        self.get_logger().info(f'I heard: {msg.data} ({age_ms:.1f} ms old)')


def main(args=None):
    rclpy.init(args=args)
    node = InfoListener()
    rclpy.spin(node)
    node.destroy_node()


if __name__ == '__main__':
    main()
