"""Right: compares the room of the last position with that of the new one."""
import rclpy
from nav_msgs.msg import Odometry
from rclpy.node import Node
from std_msgs.msg import String


def room_of(x):
    return "left" if x < 4 else "right"


class Reporter(Node):
    def __init__(self):
        super().__init__("reporter")
        self.before = None
        self.publisher = self.create_publisher(String, "/chatter", 10)
        self.create_subscription(Odometry, "/odom", self.report, 10)

    def report(self, message):
        x = message.pose.pose.position.x
        if self.before is None or room_of(self.before) != room_of(x):
            text = String()
            text.data = "I am in the " + room_of(x) + " room"
            self.publisher.publish(text)
        self.before = x


def main():
    rclpy.init()
    rclpy.spin(Reporter())


main()
