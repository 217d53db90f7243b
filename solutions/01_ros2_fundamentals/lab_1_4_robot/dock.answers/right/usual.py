# Right: what the notebook asks for, as a program.
import time

import rclpy
from geometry_msgs.msg import Twist
from rclpy.action import ActionServer
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from sensor_msgs.msg import LaserScan
from small_robot_interfaces.action import WalkTo


class Dock(Node):
    def __init__(self):
        super().__init__("dock")
        self.ahead = 0.0
        self.create_subscription(LaserScan, "scan", self.on_scan, 10)
        self.velocity = self.create_publisher(Twist, "cmd_vel", 10)
        self.server = ActionServer(self, WalkTo, "dock", execute_callback=self.dock)

    def on_scan(self, scan):
        self.ahead = scan.ranges[0]

    def dock(self, goal_handle):
        left = goal_handle.request.x
        if left > self.ahead:
            goal_handle.abort()
            return WalkTo.Result(arrived=False)
        command = Twist()
        command.linear.x = 0.5
        while left > 0.0:
            self.velocity.publish(command)
            left -= 0.25
            goal_handle.publish_feedback(WalkTo.Feedback(distance=left))
            time.sleep(0.5)
        self.velocity.publish(Twist())
        goal_handle.succeed()
        return WalkTo.Result(arrived=True)


def main():
    rclpy.init()
    rclpy.spin(Dock(), MultiThreadedExecutor(num_threads=2))


if __name__ == "__main__":
    main()
