import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from sensor_msgs.msg import LaserScan


class Brake(Node):
    def __init__(self):
        super().__init__("brake")
        self.publisher = self.create_publisher(Twist, "cmd_vel", 10)
        self.create_subscription(LaserScan, "scan", self.look, 10)

    def look(self, scan):
        command = Twist()
        if scan.ranges[0] > 0.8:
            command.linear.x = 0.3
        self.publisher.publish(command)


def main():
    rclpy.init()
    rclpy.spin(Brake())


if __name__ == "__main__":
    main()
