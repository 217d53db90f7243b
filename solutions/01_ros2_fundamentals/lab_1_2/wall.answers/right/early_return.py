"""Right: an early return, names without a slash, other depths."""
import rclpy
from geometry_msgs.msg import Twist, Vector3
from rclpy.node import Node
from sensor_msgs.msg import LaserScan

STOP = Twist()
DRIVE = Twist(linear=Vector3(x=0.5))


class WallGuard(Node):
    def __init__(self):
        super().__init__("wall_guard")
        self.wheels = self.create_publisher(Twist, "cmd_vel", 1)
        self.laser = self.create_subscription(LaserScan, "scan", self.look, 1)

    def look(self, scan):
        if scan.ranges[0] <= 0.8:
            self.wheels.publish(STOP)
            return
        self.wheels.publish(DRIVE)


def main():
    rclpy.init()
    rclpy.spin(WallGuard())


if __name__ == "__main__":
    main()
