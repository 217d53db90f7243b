# Right: a class, as the solution.
import math

import rclpy
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import Bool, Float64
from std_srvs.srv import SetBool


class Converter(Node):
    def __init__(self):
        super().__init__("converter")
        self.is_on = True
        self.declare_parameter("offset", 0.0)
        self.publisher = self.create_publisher(Float64, "fahrenheit", 10)
        qos = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.changes = self.create_publisher(Bool, "is_on", qos)
        self.create_subscription(Float64, "celsius", self.convert, 10)
        self.create_service(SetBool, "power", self.switch)

    def convert(self, message):
        if math.isnan(message.data) or not self.is_on:
            return
        celsius = message.data + self.get_parameter("offset").value
        self.publisher.publish(Float64(data=celsius * 9 / 5 + 32))

    def switch(self, request, response):
        if request.data == self.is_on:
            response.success = False
            response.message = "already so"
            return response
        self.is_on = request.data
        self.changes.publish(Bool(data=self.is_on))
        response.success = True
        return response


rclpy.init()
rclpy.spin(Converter())
