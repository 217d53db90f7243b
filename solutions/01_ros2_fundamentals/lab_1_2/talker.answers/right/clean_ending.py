"""Right: ends without a traceback, formats with %, QoSProfile with a depth, a node name of its own."""
import sys

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import QoSProfile
from std_msgs.msg import String


class Greeter(Node):
    def __init__(self, name):
        super().__init__(name)
        self._pub = self.create_publisher(String, 'chatter', QoSProfile(depth=5))
        self._sent = 0
        self.create_timer(0.5, self.greet)

    def greet(self):
        text = 'Hello, world! %d' % self._sent
        self._pub.publish(String(data=text))
        self.get_logger().warning('sent %s' % text)
        self._sent += 1


def main():
    rclpy.init(args=sys.argv)
    node = Greeter('greeter_of_the_lab')
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
