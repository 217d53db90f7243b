# Right: what the notebook asks for, as a program.
import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node


class Driver(Node):
    def __init__(self):
        super().__init__("driver")
        self.publisher = self.create_publisher(Twist, "/cmd_vel", 10)
        self.create_timer(0.5, self.drive)

    def drive(self):
        command = Twist()
        command.linear.x = 0.5
        self.publisher.publish(command)


rclpy.init()
rclpy.spin(Driver())
