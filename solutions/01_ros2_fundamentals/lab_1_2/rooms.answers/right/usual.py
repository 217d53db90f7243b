"""Right: the usual reporter."""
import rclpy
from nav_msgs.msg import Odometry
from rclpy.node import Node
from std_msgs.msg import String


class Reporter(Node):
    def __init__(self):
        super().__init__("reporter")
        self.room = ""
        self.publisher = self.create_publisher(String, "chatter", 10)
        self.create_subscription(Odometry, "/odom", self.on_odometry, 10)

    def on_odometry(self, message):
        room = "left" if message.pose.pose.position.x < 4 else "right"
        if room != self.room:
            self.room = room
            self.publisher.publish(String(data=f"I am in the {room} room"))


def main():
    rclpy.init()
    rclpy.spin(Reporter())


if __name__ == "__main__":
    main()
