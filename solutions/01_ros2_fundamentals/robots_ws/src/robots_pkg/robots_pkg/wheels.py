import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from std_msgs.msg import Float64


class Wheels(Node):
    """Publishes on turns how fast the wheels of a robot turn, for each command on cmd_vel."""

    def __init__(self) -> None:
        super().__init__("wheels")
        self.turns = self.create_publisher(Float64, "turns", 10)
        self.create_subscription(Twist, "cmd_vel", self.on_command, 10)

    def on_command(self, command: Twist) -> None:
        self.turns.publish(Float64(data=command.linear.x / 0.1))


def main() -> None:
    rclpy.init()
    rclpy.spin(Wheels())
