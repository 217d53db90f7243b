"""Right: the default of the parameter is in seconds."""
import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class Greeter(Node):
    def __init__(self):
        super().__init__("greeter")
        self.count = 0
        self.chatter = self.create_publisher(String, "chatter", 10)
        period = self.declare_parameter("period", 0.5).value
        self.create_timer(period, self.greet)
        self.get_logger().info("I greet whoever comes")

    def greet(self):
        self.chatter.publish(String(data=f"Hello, world! {self.count}"))
        self.count += 1


rclpy.init()
rclpy.spin(Greeter())
