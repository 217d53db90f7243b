# Right: a class with a callback that publishes.
import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64


class Converter(Node):
    def __init__(self):
        super().__init__("converter")
        self.publisher = self.create_publisher(Float64, "fahrenheit", 10)
        self.create_subscription(Float64, "celsius", self.convert, 10)

    def convert(self, message):
        self.publisher.publish(Float64(data=message.data * 9 / 5 + 32))


rclpy.init()
rclpy.spin(Converter())
