# Right: what the notebook asks for, as a program.
import rclpy
from rclpy.action import ActionClient
from rclpy.node import Node
from sensor_msgs.msg import LaserScan
from small_robot_interfaces.action import WalkTo


class Cautious(Node):
    def __init__(self):
        super().__init__("cautious")
        self.goal_handle = None
        self.create_subscription(LaserScan, "/scan", self.on_scan, 10)
        self.walk = ActionClient(self, WalkTo, "walk_to")
        self.walk.wait_for_server(timeout_sec=5.0)
        sent = self.walk.send_goal_async(WalkTo.Goal(x=5.5, y=2.0))
        sent.add_done_callback(self.on_goal)

    def on_goal(self, sent):
        self.goal_handle = sent.result()

    def on_scan(self, scan):
        if scan.ranges[0] < 1.5 and self.goal_handle is not None:
            self.goal_handle.cancel_goal_async()
            self.goal_handle = None


rclpy.init()
rclpy.spin(Cautious())
