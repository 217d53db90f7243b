"""Right: both nodes stay as they are, and one executor spins both."""
import rclpy
from nav_msgs.msg import Odometry
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import String


class Tracker(Node):
    def __init__(self, report):
        super().__init__("tracker")
        self.report, self.room = report, ""
        self.create_subscription(Odometry, "/odom", self.on_odometry, 10)

    def on_odometry(self, odometry):
        room = "left" if odometry.pose.pose.position.x < 4 else "right"
        if room != self.room:
            self.room = room
            self.report(room)


class Guide(Node):
    def __init__(self):
        super().__init__("guide")
        self.chatter = self.create_publisher(String, "chatter", 10)
        self.tracker = Tracker(self.say)

    def say(self, room):
        self.chatter.publish(String(data=f"I am in the {room} room"))


rclpy.init()
guide = Guide()
executor = SingleThreadedExecutor()
executor.add_node(guide)
executor.add_node(guide.tracker)
executor.spin()
