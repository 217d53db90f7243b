"""Right: the callback sends the request and goes on, and the answer has a callback of its own."""

import rclpy
from nav_msgs.msg import Odometry
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from std_srvs.srv import SetBool


class Doorkeeper(Node):
    def __init__(self):
        super().__init__("doorkeeper")
        self.is_on = False
        self.lamp = self.create_client(SetBool, "lamp")
        self.create_subscription(Odometry, "/odom", self.on_odom, 10)

    def on_odom(self, odom):
        near = abs(odom.pose.pose.position.x - 4.0) < 1.0
        if near != self.is_on:
            self.is_on = near
            answered = self.lamp.call_async(SetBool.Request(data=near))
            answered.add_done_callback(lambda future: self.get_logger().info(future.result().message))


rclpy.init()
rclpy.spin(Doorkeeper(), executor=MultiThreadedExecutor(num_threads=2))
