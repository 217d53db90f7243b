"""Right: a context and an executor of its own, both as with-statements; the default context is never touched."""
from contextlib import suppress

from rclpy.context import Context
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import String


class Talker(Node):
    def __init__(self, context):
        super().__init__('talker_in_a_context', context=context)
        self.pub = self.create_publisher(String, 'chatter', 10)
        self.i = 0
        self.create_timer(0.5, self.tick)

    def tick(self):
        self.pub.publish(String(data='Hello, world! ' + repr(self.i)))
        self.i += 1


with suppress(KeyboardInterrupt, ExternalShutdownException):
    with Context() as context, SingleThreadedExecutor(context=context) as executor:
        executor.add_node(Talker(context))
        executor.spin()
