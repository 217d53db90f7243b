# Right: the callback only keeps, and a timer publishes what was kept.
import math

import rclpy
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import Bool, Float64
from std_srvs.srv import SetBool


class Thermometer(Node):
    def __init__(self):
        super().__init__("thermometer")
        self.declare_parameter("offset", 0.0)
        self.is_on, self.told, self.kept = True, True, []
        self.publisher = self.create_publisher(Float64, "fahrenheit", 10)
        qos = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.changes = self.create_publisher(Bool, "is_on", qos)
        self.create_subscription(Float64, "celsius", self.keep, 10)
        self.create_service(SetBool, "power", self.switch)
        self.create_timer(0.05, self.tell)

    def keep(self, message):
        if self.is_on and not math.isnan(message.data):
            self.kept.append(message.data + self.get_parameter("offset").value)

    def switch(self, request, response):
        response.success = request.data != self.is_on
        response.message = "" if response.success else "I am already so"
        self.is_on = request.data
        return response

    def tell(self):
        while self.kept:
            self.publisher.publish(Float64(data=32 + self.kept.pop(0) * 1.8))
        if self.is_on != self.told:
            self.told = self.is_on
            self.changes.publish(Bool(data=self.told))


rclpy.init()
rclpy.spin(Thermometer())
