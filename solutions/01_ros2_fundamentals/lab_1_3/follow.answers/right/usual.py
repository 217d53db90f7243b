"""Right: the usual follower."""
import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from sensor_msgs.msg import LaserScan
from std_srvs.srv import SetBool


class Follower(Node):
    def __init__(self):
        super().__init__("follower")
        self.publisher = self.create_publisher(Twist, "/cmd_vel", 10)
        self.create_subscription(LaserScan, "/scan", self.on_scan, 10)
        self.follows = False
        self.create_service(SetBool, "follow", self.on_follow)

    def on_follow(self, request, response):
        self.follows = request.data
        response.success = True
        response.message = "following" if request.data else "staying"
        return response

    def on_scan(self, scan):
        command = Twist()
        if self.follows and scan.ranges[0] > 0.8:
            command.linear.x = 0.5
        self.publisher.publish(command)


def main():
    rclpy.init()
    rclpy.spin(Follower())


if __name__ == "__main__":
    main()
