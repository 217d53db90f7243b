import rclpy
from geometry_msgs.msg import Twist, Vector3
from rclpy.node import Node
from std_msgs.msg import Float64


class Driver(Node):
    """Publishes the speed that it hears on speed as a command on drive."""

    def __init__(self) -> None:
        super().__init__("driver")
        self.command = self.create_publisher(Twist, "drive", 10)
        self.create_subscription(Float64, "speed", self.on_speed, 10)

    def on_speed(self, speed: Float64) -> None:
        self.command.publish(Twist(linear=Vector3(x=speed.data)))


def main() -> None:
    rclpy.init()
    rclpy.spin(Driver())
