"""Right: remembers the whole string, starts with None, logs what it says."""
import rclpy
from nav_msgs.msg import Odometry
from rclpy.node import Node
from std_msgs.msg import String


class Reporter(Node):
    def __init__(self):
        super().__init__("reporter")
        self.said = None
        self.publisher = self.create_publisher(String, "/chatter", 1)
        self.subscription = self.create_subscription(Odometry, "odom", self.listen, 50)

    def listen(self, odometry):
        text = "I am in the right room"
        if odometry.pose.pose.position.x < 4.0:
            text = "I am in the left room"
        if text == self.said:
            return
        self.said = text
        message = String()
        message.data = text
        self.publisher.publish(message)
        self.get_logger().info(text)


def main():
    rclpy.init()
    rclpy.spin(Reporter())


if __name__ == "__main__":
    main()
