"""Right: with-statements for context and executor; logs at debug level after switching that level on."""
from contextlib import suppress

from rclpy.context import Context
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.logging import LoggingSeverity
from rclpy.node import Node
from std_msgs.msg import String


def main():
    with Context() as context, SingleThreadedExecutor(context=context) as executor:
        node = Node('debugging_listener', context=context)
        node.get_logger().set_level(LoggingSeverity.DEBUG)
        node.create_subscription(String, 'chatter', lambda msg: node.get_logger().debug(msg.data), 10)
        executor.add_node(node)
        executor.spin()


with suppress(KeyboardInterrupt, ExternalShutdownException):
    main()
