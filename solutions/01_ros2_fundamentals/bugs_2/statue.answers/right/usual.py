"""Right: the response is returned."""

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from sensor_msgs.msg import LaserScan
from std_srvs.srv import SetBool


class Follower(Node):
    def __init__(self):
        super().__init__("follower")
        self.follows = False
        self.velocity = self.create_publisher(Twist, "/cmd_vel", 10)
        self.create_subscription(LaserScan, "/scan", self.on_scan, 10)
        self.create_service(SetBool, "follow", self.on_follow)

    def on_scan(self, scan):
        command = Twist()
        if self.follows and scan.ranges[0] > 0.8:
            command.linear.x = 0.5
        self.velocity.publish(command)

    def on_follow(self, request, response):
        self.follows = request.data
        response.success = True
        response.message = "following" if request.data else "staying"
        self.get_logger().info(response.message)
        return response


rclpy.init()
rclpy.spin(Follower())
