# Right: each heartbeat resets a timer of one second; no time is kept.
import rclpy
from rclpy.node import Node
from std_msgs.msg import Empty, String


class Watchdog(Node):
    def __init__(self):
        super().__init__("dog")
        self.alarm = self.create_publisher(String, "/alarm", 1)
        self.create_subscription(Empty, "/heartbeat", self.on_beat, 1)
        self.timer = self.create_timer(1.0, self.on_silence)
        self.timer.cancel()
        self.is_lost = False

    def on_beat(self, _):
        self.timer.reset()
        if self.is_lost:
            self.is_lost = False
            self.alarm.publish(String(data="back"))

    def on_silence(self):
        self.timer.cancel()
        self.is_lost = True
        self.alarm.publish(String(data="lost"))


def main():
    rclpy.init()
    node = Watchdog()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass


if __name__ == "__main__":
    main()
