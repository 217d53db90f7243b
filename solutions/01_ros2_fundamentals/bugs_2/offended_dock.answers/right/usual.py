"""Right: a goal that is aborted clears the flag, too."""

import time

import rclpy
from geometry_msgs.msg import Twist, Vector3
from rclpy.action import ActionServer, GoalResponse
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from sensor_msgs.msg import LaserScan
from small_robot_interfaces.action import WalkTo


class Dock(Node):
    def __init__(self):
        super().__init__("dock")
        self.ahead = 0.0
        self.is_busy = False
        self.create_subscription(LaserScan, "scan", self.on_scan, 10)
        self.velocity = self.create_publisher(Twist, "cmd_vel", 10)
        self.server = ActionServer(
            self, WalkTo, "dock", execute_callback=self.dock, goal_callback=self.on_goal
        )

    def on_scan(self, scan):
        self.ahead = scan.ranges[0]

    def on_goal(self, goal):
        if self.is_busy:
            return GoalResponse.REJECT
        self.is_busy = True
        return GoalResponse.ACCEPT

    def dock(self, goal_handle):
        left = goal_handle.request.x
        if left > self.ahead:
            self.get_logger().warning("a wall is in the way")
            self.is_busy = False
            goal_handle.abort()
            return WalkTo.Result(arrived=False)
        while left > 0.0:
            self.velocity.publish(Twist(linear=Vector3(x=0.5)))
            time.sleep(0.5)
            left -= 0.25
            goal_handle.publish_feedback(WalkTo.Feedback(distance=left))
        self.velocity.publish(Twist())
        self.is_busy = False
        goal_handle.succeed()
        return WalkTo.Result(arrived=True)


rclpy.init()
rclpy.spin(Dock(), executor=MultiThreadedExecutor(num_threads=2))
