"""Right: the name of the topic is corrected."""

import rclpy
from rclpy.node import Node
from std_msgs.msg import Int32, String


class Display(Node):
    def __init__(self):
        super().__init__("display")
        self.shown = self.create_publisher(String, "shown", 10)
        self.create_subscription(Int32, "number", self.show, 10)

    def show(self, number):
        self.shown.publish(String(data=f"Number: {number.data}"))


rclpy.init()
rclpy.spin(Display())
