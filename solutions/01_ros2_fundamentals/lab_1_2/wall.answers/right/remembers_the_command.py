"""Right: one command that is changed, an if and an else, spinning with several threads."""
import rclpy
from geometry_msgs.msg import Twist
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from sensor_msgs.msg import LaserScan


class Brake(Node):
    def __init__(self):
        super().__init__("brake")
        self.command = Twist()
        self.pub = self.create_publisher(Twist, "cmd_vel", 10)
        self.sub = self.create_subscription(LaserScan, "scan", self.callback, 10)

    def callback(self, msg):
        front = msg.ranges[0]
        if front < 0.8:
            self.command.linear.x = 0.0
        else:
            self.command.linear.x = 0.5
        self.pub.publish(self.command)


rclpy.init()
rclpy.spin(Brake(), executor=MultiThreadedExecutor(2))
