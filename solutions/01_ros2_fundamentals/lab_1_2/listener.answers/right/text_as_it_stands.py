"""Right: the course text's own listener. Its traceback after Ctrl-C says nothing about the node."""
import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class ListenerNode(Node):
    def __init__(self):
        super().__init__('listener_node')
        # Create a subscriber to the 'chatter' topic with String messages
        self.subscription = self.create_subscription(
            String,
            'chatter',
            self.listener_callback,
            10)
        self.subscription  # prevent unused variable warning
        self.get_logger().info('Listener node has started and is subscribing...')

    def listener_callback(self, msg):
        self.get_logger().info(f'I heard: "{msg.data}"')


def main(args=None):
    rclpy.init(args=args)
    listener_node = ListenerNode()
    try:
        rclpy.spin(listener_node)
    except KeyboardInterrupt:
        pass
    listener_node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
