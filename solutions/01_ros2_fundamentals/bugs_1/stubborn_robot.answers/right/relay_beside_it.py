"""Right: the driver stays as it is, under another name, and a second node takes the stamp off."""
import rclpy
from geometry_msgs.msg import Twist, TwistStamped
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from sensor_msgs.msg import LaserScan


class Careful(Node):
    def __init__(self):
        super().__init__("careful")
        self.command = self.create_publisher(TwistStamped, "/cmd_vel_stamped", 10)
        self.create_subscription(LaserScan, "/scan", self.on_scan, 10)

    def on_scan(self, scan):
        command = TwistStamped()
        command.header.stamp = self.get_clock().now().to_msg()
        if scan.ranges[0] > 0.8:
            command.twist.linear.x = 0.5
        self.command.publish(command)
        self.get_logger().info(f"I drive with {command.twist.linear.x} m/s")


class Relay(Node):
    def __init__(self):
        super().__init__("relay")
        self.command = self.create_publisher(Twist, "/cmd_vel", 10)
        self.create_subscription(TwistStamped, "/cmd_vel_stamped", self.pass_on, 10)

    def pass_on(self, command):
        self.command.publish(command.twist)


rclpy.init()
executor = SingleThreadedExecutor()
executor.add_node(Careful())
executor.add_node(Relay())
executor.spin()
