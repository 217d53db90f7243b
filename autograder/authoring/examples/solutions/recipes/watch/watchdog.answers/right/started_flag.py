# Right: watches from the start, and is quiet until the first heartbeat; looks every 0.25 s.
import rclpy
from rclpy.node import Node
from std_msgs.msg import Empty, String


class Watchdog(Node):
    def __init__(self):
        super().__init__("watchdog")
        self.publisher = self.create_publisher(String, "alarm", 10)
        self.create_subscription(Empty, "heartbeat", self.beat, 10)
        self.create_timer(0.25, self.look)
        self.last, self.started = self.get_clock().now(), False
        self.lost = False

    def beat(self, message):
        self.started = True
        self.last = self.get_clock().now()
        if self.lost:
            self.lost = False
            self.publisher.publish(String(data="back"))

    def look(self):
        if not self.started or self.lost:
            return
        if (self.get_clock().now() - self.last).nanoseconds >= 1e9:
            self.lost = True
            self.publisher.publish(String(data="lost"))


rclpy.init()
rclpy.spin(Watchdog())
