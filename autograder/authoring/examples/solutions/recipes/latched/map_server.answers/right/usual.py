# Right: transient local, published once.
import rclpy
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String


class MapServer(Node):
    def __init__(self):
        super().__init__("map_server")
        qos = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.publisher = self.create_publisher(String, "map_name", qos)
        self.publisher.publish(String(data="kitchen"))


rclpy.init()
rclpy.spin(MapServer())
