"""Wrong, row 11: subscribes with Int32; the talker sends String."""
import rclpy
from rclpy.node import Node
from std_msgs.msg import Int32


class ListenerNode(Node):
    def __init__(self):
        super().__init__('listener_node')
        self.subscription = self.create_subscription(Int32, 'chatter', self.listener_callback, 10)

    def listener_callback(self, msg):
        self.get_logger().info(f'I heard: "{msg.data}"')


def main(args=None):
    rclpy.init(args=args)
    node = ListenerNode()
    rclpy.spin(node)


if __name__ == '__main__':
    main()
