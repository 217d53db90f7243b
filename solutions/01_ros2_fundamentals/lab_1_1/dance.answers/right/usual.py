# Right: what the notebook asks for, as a program.
import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node


class Dancer(Node):
    def __init__(self):
        super().__init__("dancer")
        self.publisher = self.create_publisher(Twist, "/cmd_vel", 10)
        self.create_timer(0.5, self.dance)

    def dance(self):
        command = Twist()
        command.linear.x = 0.3
        command.angular.z = 1.0
        self.publisher.publish(command)


rclpy.init()
rclpy.spin(Dancer())
