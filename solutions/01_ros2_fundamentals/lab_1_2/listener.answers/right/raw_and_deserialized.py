"""Right: takes the serialized bytes, unpacks them itself, uses the system default QoS."""
import rclpy
from rclpy.node import Node
from rclpy.qos import qos_profile_system_default
from rclpy.serialization import deserialize_message
from std_msgs.msg import String


class RawListener(Node):
    def __init__(self):
        super().__init__('raw_listener')
        self.create_subscription(String, 'chatter', self.heard, qos_profile_system_default, raw=True)

    def heard(self, data):
        msg = deserialize_message(data, String)
        self.get_logger().info(f'{len(data)} bytes: {msg.data}')


def main():
    rclpy.init()
    rclpy.spin(RawListener())


if __name__ == '__main__':
    main()
