"""Right: the commands are reliable; the scans may still be lost."""
import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import LaserScan
from std_srvs.srv import SetBool

NEWEST_ONLY = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)


class Follower(Node):
    def __init__(self):
        super().__init__("follower")
        self.follows = False
        self.command = self.create_publisher(Twist, "/cmd_vel", 1)
        self.create_subscription(LaserScan, "/scan", self.on_scan, NEWEST_ONLY)
        self.create_service(SetBool, "follow", self.on_follow)

    def on_follow(self, request, response):
        self.follows = request.data
        response.success, response.message = True, "following" if request.data else "staying"
        return response

    def on_scan(self, scan):
        command = Twist()
        if self.follows and scan.ranges[0] > 0.8:
            command.linear.x = 0.5
        self.command.publish(command)


rclpy.init()
rclpy.spin(Follower())
