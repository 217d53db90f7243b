# Right: a class that counts.
import rclpy
from rclpy.node import Node
from std_srvs.srv import Trigger


class Door(Node):
    def __init__(self):
        super().__init__("door")
        self.visitors = 0
        self.create_service(Trigger, "visit", self.count)

    def count(self, request, response):
        self.visitors += 1
        response.success = True
        response.message = f"visitor {self.visitors}"
        return response


rclpy.init()
rclpy.spin(Door())
