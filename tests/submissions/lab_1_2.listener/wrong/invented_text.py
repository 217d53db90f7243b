"""Wrong: a timer says what the course's talker would have sent; nobody sent it."""
import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class ListenerNode(Node):
    def __init__(self):
        super().__init__('listener_node')
        self.subscription = self.create_subscription(String, 'chatter', lambda msg: None, 10)
        self.i = 0
        self.create_timer(0.5, self.listener_callback)

    def listener_callback(self):
        self.get_logger().info(f'I heard: "Hello, world! {self.i}"')
        self.i += 1


def main(args=None):
    rclpy.init(args=args)
    node = ListenerNode()
    rclpy.spin(node)


if __name__ == '__main__':
    main()
