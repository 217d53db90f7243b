# Right: the level is checked where it is set.
import rclpy
from power_interfaces.srv import SetLevel
from rclpy.node import Node
from std_msgs.msg import Int32


class Dimmer(Node):
    def __init__(self):
        super().__init__("dimmer")
        self.level = 0
        self.publisher = self.create_publisher(Int32, "level", 10)
        self.create_service(SetLevel, "set_level", self.set_level)
        self.create_timer(0.2, self.tell)

    def set_level(self, request, response):
        response.accepted = 0 <= request.percent <= 100
        if response.accepted:
            self.level = request.percent
        return response

    def tell(self):
        self.publisher.publish(Int32(data=self.level))


rclpy.init()
rclpy.spin(Dimmer())
