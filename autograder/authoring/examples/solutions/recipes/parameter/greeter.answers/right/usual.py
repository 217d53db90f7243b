# Right: asks for the parameter each time.
import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class Greeter(Node):
    def __init__(self):
        super().__init__("greeter")
        self.declare_parameter("text", "Hello")
        self.publisher = self.create_publisher(String, "greeting", 10)
        self.create_timer(0.5, self.greet)

    def greet(self):
        text = self.get_parameter("text").value
        self.publisher.publish(String(data=text))


rclpy.init()
rclpy.spin(Greeter())
