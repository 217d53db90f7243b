"""Right: the sensor's quality of service, no class, a log line for each command."""
import rclpy
from geometry_msgs.msg import Twist
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import LaserScan

rclpy.init()
node = rclpy.create_node("careful")
publisher = node.create_publisher(Twist, "/cmd_vel", 10)


def answer(scan):
    command = Twist()
    command.linear.x = 0.5 if scan.ranges[0] >= 0.8 else 0.0
    node.get_logger().info(f"{scan.ranges[0]:.2f} m: {command.linear.x}")
    publisher.publish(command)


subscription = node.create_subscription(LaserScan, "/scan", answer, qos_profile_sensor_data)
rclpy.spin(node)
