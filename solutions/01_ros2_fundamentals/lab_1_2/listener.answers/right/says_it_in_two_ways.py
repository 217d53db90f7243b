"""Right: two log lines of different words for each text."""
import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class ListenerNode(Node):
    def __init__(self):
        super().__init__('listener_node')
        self.create_subscription(String, 'chatter', self.listener_callback, 10)

    def listener_callback(self, msg):
        self.get_logger().info(f'I heard: "{msg.data}"')
        self.get_logger().info(f'{len(msg.data)} letters: {msg.data}')


def main():
    rclpy.init()
    rclpy.spin(ListenerNode())


if __name__ == '__main__':
    main()
