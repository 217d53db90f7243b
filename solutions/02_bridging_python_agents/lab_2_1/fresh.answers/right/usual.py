# Right: what the notebook asks for, as a program.
from typing import Any

import rclpy
from geometry_msgs.msg import Twist
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import LaserScan
from std_msgs.msg import String


class Memory(Node):
    """Keeps what the robot saw last, and knows how old it is."""

    def __init__(self) -> None:
        super().__init__("memory")
        self.ahead = 0.0
        self.came_at: Any = None

    def on_scan(self, scan: LaserScan) -> None:
        """Keep the newest scan, and when it came."""
        self.ahead = scan.ranges[0]
        self.came_at = self.get_clock().now()

    def state(self) -> str:
        """Return in a word how old the newest scan is."""
        if self.came_at is None:
            return "nothing"
        return "fresh" if self.get_clock().now() - self.came_at < Duration(seconds=1) else "old"


class CarefulDriver(Memory):
    """Drives only while it knows what is ahead."""

    def __init__(self) -> None:
        super().__init__()
        self.known = self.create_publisher(String, "known", 10)
        self.velocity = self.create_publisher(Twist, "cmd_vel", 10)
        self.create_timer(0.2, self.act)
        self.create_subscription(LaserScan, "scan", self.on_scan, qos_profile_sensor_data)

    def act(self) -> None:
        """Say what is known, and drive if that is enough."""
        self.known.publish(String(data=self.state()))
        command = Twist()
        if self.state() == "fresh" and self.ahead > 0.8:
            command.linear.x = 0.4
        self.velocity.publish(command)


rclpy.init()
rclpy.spin(CarefulDriver())
