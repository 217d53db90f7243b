"""Right: the name of the service begins with a slash, as that of the topic does."""
import rclpy
from nav_msgs.msg import Odometry
from rclpy.node import Node
from std_srvs.srv import SetBool


class DoorLight(Node):
    def __init__(self):
        super().__init__("door_light", namespace="hall")
        self.lamp = self.create_client(SetBool, "/lamp")
        self.is_on = False
        self.create_subscription(Odometry, "/odom", self.on_odometry, 10)

    def on_odometry(self, odometry):
        is_near = abs(odometry.pose.pose.position.x - 4.0) < 1.0
        if is_near != self.is_on:
            self.is_on = is_near
            self.lamp.call_async(SetBool.Request(data=is_near))


rclpy.init()
rclpy.spin(DoorLight())
