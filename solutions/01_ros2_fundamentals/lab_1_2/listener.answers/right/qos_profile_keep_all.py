"""Right: a QoSProfile spelt out; keeps its texts in a list and logs each with its number."""
import rclpy
from rclpy.node import Node
from rclpy.qos import QoSDurabilityPolicy, QoSHistoryPolicy, QoSProfile, QoSReliabilityPolicy
from std_msgs.msg import String


class Collector(Node):
    def __init__(self):
        super().__init__('collector', namespace='classroom')
        qos = QoSProfile(
            history=QoSHistoryPolicy.KEEP_ALL,
            reliability=QoSReliabilityPolicy.RELIABLE,
            durability=QoSDurabilityPolicy.VOLATILE,
        )
        self.texts = []
        self.sub = self.create_subscription(String, '/chatter', self.collect, qos)

    def collect(self, msg):
        self.texts.append(msg.data)
        self.get_logger().info('#{} {}'.format(len(self.texts), self.texts[-1]))


def main():
    rclpy.init()
    rclpy.spin(Collector())


if __name__ == '__main__':
    main()
