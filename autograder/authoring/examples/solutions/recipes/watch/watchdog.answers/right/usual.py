# Right: a timer looks every 0.1 s how old the last heartbeat is.
import rclpy
from rclpy.node import Node
from std_msgs.msg import Empty, String


class Watchdog(Node):
    def __init__(self):
        super().__init__("watchdog")
        self.publisher = self.create_publisher(String, "alarm", 10)
        self.create_subscription(Empty, "heartbeat", self.beat, 10)
        self.create_timer(0.1, self.look)
        self.last = None
        self.lost = False

    def beat(self, message):
        self.last = self.get_clock().now()
        if self.lost:
            self.lost = False
            self.publisher.publish(String(data="back"))

    def look(self):
        if self.last is None or self.lost:
            return
        if (self.get_clock().now() - self.last).nanoseconds >= 1e9:
            self.lost = True
            self.publisher.publish(String(data="lost"))


rclpy.init()
rclpy.spin(Watchdog())
