"""Right: a best-effort listener hears a reliable talker; formats with %."""
import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from std_msgs.msg import String


class SensorListener(Node):
    def __init__(self):
        super().__init__('sensor_listener')
        self.create_subscription(String, 'chatter', self.on_message, qos_profile_sensor_data)

    def on_message(self, message):
        self.get_logger().info('received "%s"' % message.data)


def main(args=None):
    try:
        rclpy.init(args=args)
        rclpy.spin(SensorListener())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
