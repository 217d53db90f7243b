"""Right: returns a response of its own, keeps the speed instead of a truth value, uses another depth."""
import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from sensor_msgs.msg import LaserScan
from std_srvs.srv import SetBool


class Follower(Node):
    def __init__(self):
        super().__init__("my_follower")
        self.speed = 0.0
        self.wheels = self.create_publisher(Twist, "cmd_vel", 1)
        self.laser = self.create_subscription(LaserScan, "scan", self.look, 1)
        self.switch = self.create_service(SetBool, "/follow", self.turn)

    def turn(self, request, _):
        if request.data:
            self.speed = 0.5
            return SetBool.Response(success=True, message="following")
        self.speed = 0.0
        return SetBool.Response(success=True, message="staying")

    def look(self, scan):
        command = Twist()
        command.linear.x = self.speed * (scan.ranges[0] > 0.8)
        self.wheels.publish(command)


def main():
    rclpy.init()
    rclpy.spin(Follower())


if __name__ == "__main__":
    main()
