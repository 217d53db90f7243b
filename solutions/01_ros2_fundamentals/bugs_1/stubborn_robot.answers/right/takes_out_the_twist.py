"""Right: the command is made as before, and what it carries is published."""
import rclpy
from geometry_msgs.msg import Twist, TwistStamped
from rclpy.node import Node
from sensor_msgs.msg import LaserScan


class Careful(Node):
    def __init__(self):
        super().__init__("careful")
        self.command = self.create_publisher(Twist, "/cmd_vel", 10)
        self.create_subscription(LaserScan, "/scan", self.on_scan, 10)

    def on_scan(self, scan):
        command = TwistStamped()
        command.header.stamp = self.get_clock().now().to_msg()
        if scan.ranges[0] > 0.8:
            command.twist.linear.x = 0.5
        self.command.publish(command.twist)
        self.get_logger().info(f"I drive with {command.twist.linear.x} m/s")


rclpy.init()
rclpy.spin(Careful())
