"""Right: an event of threading wakes the thread that waits, and the executor keeps the node."""

import time
from threading import Event

import rclpy
from geometry_msgs.msg import Twist, Vector3
from rclpy.action import ActionServer
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from rclpy.task import Future
from sensor_msgs.msg import LaserScan
from small_robot_interfaces.action import WalkTo


class PatientDock(Node):
    def __init__(self):
        super().__init__("dock")
        self.ahead = 0.0
        self.has_seen = Event()
        self.create_subscription(LaserScan, "scan", self.on_scan, 10)
        self.velocity = self.create_publisher(Twist, "cmd_vel", 10)
        self.server = ActionServer(self, WalkTo, "dock", execute_callback=self.dock)

    def on_scan(self, scan):
        self.ahead = scan.ranges[0]
        self.has_seen.set()

    def dock(self, goal_handle):
        self.has_seen.wait()
        left = goal_handle.request.x
        if left > self.ahead:
            goal_handle.abort()
            return WalkTo.Result(arrived=False)
        while left > 0.0:
            self.velocity.publish(Twist(linear=Vector3(x=0.5)))
            time.sleep(0.5)
            left -= 0.25
            goal_handle.publish_feedback(WalkTo.Feedback(distance=left))
        self.velocity.publish(Twist())
        goal_handle.succeed()
        return WalkTo.Result(arrived=True)


rclpy.init()
rclpy.spin(PatientDock(), executor=MultiThreadedExecutor(num_threads=2))
