# Right: a flag, and a timer that looks at it.
import rclpy
from rclpy.node import Node
from std_msgs.msg import Int32
from std_srvs.srv import SetBool


class Lamp(Node):
    def __init__(self):
        super().__init__("lamp")
        self.on, self.count = False, 0
        self.publisher = self.create_publisher(Int32, "blink", 10)
        self.create_service(SetBool, "lamp", self.switch)
        self.create_timer(0.2, self.blink)

    def switch(self, request, response):
        self.on = request.data
        response.success = True
        return response

    def blink(self):
        if self.on:
            self.count += 1
            self.publisher.publish(Int32(data=self.count))


rclpy.init()
rclpy.spin(Lamp())
