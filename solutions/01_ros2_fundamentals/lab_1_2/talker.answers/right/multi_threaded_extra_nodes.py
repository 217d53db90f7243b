"""Right: a MultiThreadedExecutor with other nodes and topics beside the talker, an echo of its own among them."""
import rclpy
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import Int32, String


class Talker(Node):
    def __init__(self):
        super().__init__('talker')
        self.pub = self.create_publisher(String, 'chatter', 10)
        self.status = self.create_publisher(Int32, 'chatter_count', 10)
        self.i = 0
        self.create_timer(0.5, self.tick)

    def tick(self):
        self.pub.publish(String(data=f'Hello, world! {self.i}'))
        self.status.publish(Int32(data=self.i))
        self.i += 1


class Echo(Node):
    def __init__(self):
        super().__init__('echo')
        self.create_subscription(String, 'chatter', self.heard, 10)

    def heard(self, msg):
        self.get_logger().info(f'own echo: {msg.data}')


rclpy.init()
executor = MultiThreadedExecutor()
for node in (Talker(), Echo(), Node('bystander')):
    executor.add_node(node)
try:
    executor.spin()
except KeyboardInterrupt:
    executor.shutdown()
