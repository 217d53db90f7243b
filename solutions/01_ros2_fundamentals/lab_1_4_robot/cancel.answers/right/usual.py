# Right: what the notebook asks for, as a program.
import time

import rclpy
from geometry_msgs.msg import Twist
from rclpy.action import ActionServer, CancelResponse
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from sensor_msgs.msg import LaserScan
from small_robot_interfaces.action import WalkTo


class SafeDock(Node):
    def __init__(self):
        super().__init__("safe_dock")
        self.ahead = 0.0
        self.create_subscription(LaserScan, "scan", self.on_scan, 10)
        self.velocity = self.create_publisher(Twist, "cmd_vel", 10)
        self.server = ActionServer(
            self, WalkTo, "dock", execute_callback=self.dock, cancel_callback=self.on_cancel
        )

    def on_scan(self, scan):
        self.ahead = scan.ranges[0]

    def dock(self, goal_handle):
        left = goal_handle.request.x
        command = Twist()
        command.linear.x = 0.5
        while left > 0.0 and not goal_handle.is_cancel_requested:
            self.velocity.publish(command)
            time.sleep(0.5)
            left -= 0.25
            goal_handle.publish_feedback(WalkTo.Feedback(distance=left))
        self.velocity.publish(Twist())
        if goal_handle.is_cancel_requested:
            goal_handle.canceled()
        else:
            goal_handle.succeed()
        return WalkTo.Result(arrived=left <= 0.0)

    def on_cancel(self, goal_handle):
        return CancelResponse.ACCEPT


def main():
    rclpy.init()
    rclpy.spin(SafeDock(), MultiThreadedExecutor(num_threads=2))


if __name__ == "__main__":
    main()
