"""Right: the room as a number, texts in a list, several threads."""
import rclpy
from nav_msgs.msg import Odometry
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import String

TEXTS = ["I am in the left room", "I am in the right room"]


class WhereAmI(Node):
    def __init__(self):
        super().__init__("where_am_i")
        self.number = -1
        self.chatter = self.create_publisher(String, "chatter", 10)
        self.create_subscription(Odometry, "odom", self.moved, 10)

    def moved(self, odometry):
        number = int(odometry.pose.pose.position.x >= 4.0)
        if self.number == number:
            return
        self.number = number
        self.chatter.publish(String(data=TEXTS[number]))


rclpy.init()
rclpy.spin(WhereAmI(), executor=MultiThreadedExecutor(2))
