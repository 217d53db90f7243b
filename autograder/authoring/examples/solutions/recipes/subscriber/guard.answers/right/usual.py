# Right: a class with a callback.
import rclpy
from rclpy.node import Node
from std_msgs.msg import Int32


class Guard(Node):
    def __init__(self):
        super().__init__("guard")
        self.create_subscription(Int32, "battery", self.look_at, 10)

    def look_at(self, message):
        if message.data < 20:
            self.get_logger().warning(f"Battery low: {message.data} %")


rclpy.init()
rclpy.spin(Guard())
