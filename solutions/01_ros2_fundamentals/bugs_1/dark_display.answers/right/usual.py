"""Right: the name of the topic is corrected."""

import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class Display(Node):
    def __init__(self):
        super().__init__("display")
        self.create_subscription(String, "chatter", self.show, 10)

    def show(self, message):
        self.get_logger().info(f"the sensor says: {message.data}")


rclpy.init()
rclpy.spin(Display())
