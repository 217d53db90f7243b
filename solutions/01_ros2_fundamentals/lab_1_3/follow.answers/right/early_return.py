"""Right: publishes a stop first, and returns; the subscription has the sensor's quality of service."""
import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import LaserScan
from std_srvs.srv import SetBool


class Robot(Node):
    on = False

    def __init__(self):
        super().__init__("robot_driver")
        self.cmd = self.create_publisher(Twist, "/cmd_vel", 10)
        self.create_subscription(LaserScan, "/scan", self.scan, qos_profile_sensor_data)
        self.create_service(SetBool, "/follow", self.set_on)

    def set_on(self, request, response):
        self.on = request.data
        response.message = "following" if self.on else "staying"
        response.success = True
        self.get_logger().info(response.message)
        return response

    def scan(self, message):
        if not self.on or message.ranges[0] <= 0.8:
            self.cmd.publish(Twist())
            return
        command = Twist()
        command.linear.x = 0.5
        self.cmd.publish(command)


rclpy.init()
rclpy.spin(Robot())
