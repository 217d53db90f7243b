"""Wrong: says what it heard and, once a second, also a text that was never sent."""
import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class ListenerNode(Node):
    def __init__(self):
        super().__init__('listener_node')
        self.subscription = self.create_subscription(String, 'chatter', self.listener_callback, 10)
        self.i = 0
        self.create_timer(0.3, self.keep_up_appearances)

    def listener_callback(self, msg):
        self.get_logger().info(f'I heard: "{msg.data}"')

    def keep_up_appearances(self):
        self.get_logger().info(f'I heard: "Hello, world! {self.i}"')
        self.i += 1


def main(args=None):
    rclpy.init(args=args)
    node = ListenerNode()
    rclpy.spin(node)


if __name__ == '__main__':
    main()
