# Right: threading.Timer in place of a timer of ROS.
import threading

import rclpy
from rclpy.node import Node
from std_msgs.msg import Empty, String


class Watchdog(Node):
    def __init__(self):
        super().__init__("watchdog")
        self.publisher = self.create_publisher(String, "alarm", 10)
        self.create_subscription(Empty, "heartbeat", self.beat, 10)
        self.timer = None
        self.lost = False

    def beat(self, message):
        if self.timer:
            self.timer.cancel()
        self.timer = threading.Timer(1.0, self.silence)
        self.timer.daemon = True
        self.timer.start()
        if self.lost:
            self.lost = False
            self.publisher.publish(String(data="back"))

    def silence(self):
        self.lost = True
        self.publisher.publish(String(data="lost"))


rclpy.init()
rclpy.spin(Watchdog())
