"""Right: the timer counts how long the tablet has been silent."""

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node


class Driver(Node):
    def __init__(self):
        super().__init__("driver")
        self.command = Twist()
        self.silent = 0
        self.velocity = self.create_publisher(Twist, "cmd_vel", 10)
        self.create_subscription(Twist, "remote", self.on_remote, 10)
        self.create_timer(0.1, self.drive)

    def on_remote(self, command):
        self.command = command
        self.silent = 0

    def drive(self):
        self.silent += 1
        self.velocity.publish(self.command if self.silent < 8 else Twist())


rclpy.init()
rclpy.spin(Driver())
