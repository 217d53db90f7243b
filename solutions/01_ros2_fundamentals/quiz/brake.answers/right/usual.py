# Right: what the notebook asks for, as a program.
import rclpy
from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy
from std_msgs.msg import Bool, Float64


class Brake(Node):
    def __init__(self):
        super().__init__("careful_brake")
        self.publisher = self.create_publisher(Bool, "brake", 10)
        profile = QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)
        self.create_subscription(Float64, "distance", self.on_distance, profile)

    def on_distance(self, message):
        self.publisher.publish(Bool(data=message.data < 0.5))


rclpy.init()
rclpy.spin(Brake())
