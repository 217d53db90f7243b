# Right: several threads, and a lock around the state.
import math
import threading

import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import Bool, Float64
from std_srvs.srv import SetBool


class Converter(Node):
    def __init__(self):
        super().__init__("several_threads")
        self.lock, self.is_on = threading.Lock(), True
        self.offset = self.declare_parameter("offset", 0.0)
        group = ReentrantCallbackGroup()
        self.publisher = self.create_publisher(Float64, "fahrenheit", 10)
        qos = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.changes = self.create_publisher(Bool, "is_on", qos)
        self.create_subscription(Float64, "celsius", self.convert, 10)
        self.create_service(SetBool, "power", self.switch, callback_group=group)

    def convert(self, message):
        with self.lock:
            if self.is_on and math.isfinite(message.data):
                celsius = message.data + self.get_parameter("offset").get_parameter_value().double_value
                self.publisher.publish(Float64(data=celsius / 5 * 9 + 32))

    def switch(self, request, response):
        with self.lock:
            if request.data == self.is_on:
                response.message = "nothing to do"
                return response
            self.is_on = request.data
            self.changes.publish(Bool(data=request.data))
        response.success = True
        return response


rclpy.init()
executor = MultiThreadedExecutor(4)
executor.add_node(Converter())
executor.spin()
