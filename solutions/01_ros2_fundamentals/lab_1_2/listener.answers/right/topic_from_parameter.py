"""Right: the topic is a parameter with a default; the whole message is logged, not its field alone."""
import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class ParametrizedListener(Node):
    def __init__(self):
        super().__init__('parametrized_listener')
        self.declare_parameter('topic', 'chatter')
        topic = self.get_parameter('topic').value
        self.create_subscription(String, topic, self.heard, 10)

    def heard(self, msg):
        self.get_logger().info(f'{msg}')


def main():
    rclpy.init()
    rclpy.spin(ParametrizedListener())


if __name__ == '__main__':
    main()
