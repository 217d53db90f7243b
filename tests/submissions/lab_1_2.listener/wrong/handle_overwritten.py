"""Wrong, row 39: every node has an attribute `handle` already; a method of that name hides it."""
import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class ListenerNode(Node):
    def __init__(self):
        super().__init__('listener_node')
        self.subscription = self.create_subscription(String, 'chatter', self.handle, 10)

    def handle(self, msg):
        self.get_logger().info(f'I heard: "{msg.data}"')


def main(args=None):
    rclpy.init(args=args)
    node = ListenerNode()
    rclpy.spin(node)


if __name__ == '__main__':
    main()
