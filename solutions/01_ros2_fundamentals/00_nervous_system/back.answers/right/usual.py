# Right: what the notebook asks for, as a program.
import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node


class Traveler(Node):
    def __init__(self):
        super().__init__("traveler")
        self.count = 0
        self.publisher = self.create_publisher(Twist, "/cmd_vel", 10)
        self.create_timer(0.5, self.drive)

    def drive(self):
        command = Twist()
        if self.count < 16:
            command.linear.x = 0.5
        elif self.count < 20:
            command.angular.z = 1.57
        elif self.count < 36:
            command.linear.x = 0.5
        self.publisher.publish(command)
        self.count += 1


rclpy.init()
rclpy.spin(Traveler())
