"""Right: the system default QoS matches the course's listener; an async timer callback; a namespace is not needed."""
import rclpy
from rclpy.node import Node
from rclpy.qos import qos_profile_system_default
from std_msgs.msg import String


class AsyncTalker(Node):
    def __init__(self):
        super().__init__('async_talker')
        self.sent = []
        self.pub = self.create_publisher(String, 'chatter', qos_profile_system_default)
        self.create_timer(0.5, self.tick)

    async def tick(self):
        text = 'Hello, world! %i' % len(self.sent)
        self.pub.publish(String(data=text))
        self.sent.append(text)


if __name__ == '__main__':
    rclpy.init()
    rclpy.spin(AsyncTalker())
