# Right: two callbacks, one method.
import rclpy
from rclpy.node import Node
from std_msgs.msg import Int32
from std_srvs.srv import Trigger


class Scales(Node):
    def __init__(self):
        super().__init__("scales")
        self.left = None
        self.right = None
        self.tared = 0
        self.publisher = self.create_publisher(Int32, "total", 10)
        self.create_subscription(Int32, "left", self.on_left, 10)
        self.create_subscription(Int32, "right", self.on_right, 10)
        self.create_service(Trigger, "tare", self.tare)

    def on_left(self, message):
        self.left = message.data
        self.tell()

    def on_right(self, message):
        self.right = message.data
        self.tell()

    def tell(self):
        if self.left is None or self.right is None:
            return
        self.publisher.publish(Int32(data=self.left + self.right - self.tared))

    def tare(self, request, response):
        if self.left is None or self.right is None:
            response.success = False
            return response
        self.tared = self.left + self.right
        response.success = True
        return response


rclpy.init()
rclpy.spin(Scales())
