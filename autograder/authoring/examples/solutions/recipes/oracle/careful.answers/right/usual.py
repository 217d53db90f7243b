"""Right: remembers when the last scan came."""

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from sensor_msgs.msg import LaserScan
from std_msgs.msg import String


class Careful(Node):
    def __init__(self):
        super().__init__("careful")
        self.state, self.heard_at = "driving", None
        self.commands = self.create_publisher(Twist, "cmd_vel", 10)
        self.states = self.create_publisher(String, "state", 10)
        self.create_subscription(LaserScan, "scan", self.perceive, 10)
        self.create_timer(0.2, self.act)

    def perceive(self, scan):
        self.heard_at = self.get_clock().now()
        nearest = min(scan.ranges[3:6])
        if nearest < 0.5:
            self.state = "turning"
        elif nearest > 0.8:
            self.state = "driving"

    def act(self):
        if self.heard_at is None or (self.get_clock().now() - self.heard_at).nanoseconds > 1e9:
            state = "blind"
        else:
            state = self.state
        command = Twist()
        if state == "driving":
            command.linear.x = 0.2
        if state == "turning":
            command.angular.z = 0.5
        self.commands.publish(command)
        self.states.publish(String(data=state))


rclpy.init()
rclpy.spin(Careful())
