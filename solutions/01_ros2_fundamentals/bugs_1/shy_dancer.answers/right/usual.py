"""Right: the timer is given a function, which calls the method."""
import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node


class Dancer(Node):
    def __init__(self):
        super().__init__("dancer")
        self.command = self.create_publisher(Twist, "/cmd_vel", 10)
        self.create_timer(0.5, lambda: self.dance(0.3, 1.0))

    def dance(self, speed, turn):
        command = Twist()
        command.linear.x, command.angular.z = speed, turn
        self.command.publish(command)


rclpy.init()
rclpy.spin(Dancer())
