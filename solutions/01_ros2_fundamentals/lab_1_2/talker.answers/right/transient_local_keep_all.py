"""Right: a QoSProfile spelt out (reliable, transient local, keep all) still serves the course's listener."""
import rclpy
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import String

LATCHED = QoSProfile(
    history=HistoryPolicy.KEEP_ALL,
    reliability=ReliabilityPolicy.RELIABLE,
    durability=DurabilityPolicy.TRANSIENT_LOCAL,
)


class LatchedTalker(Node):
    def __init__(self):
        super().__init__('latched_talker')
        self.pub = self.create_publisher(String, 'chatter', LATCHED)
        self.next = 0
        self.create_timer(0.5, self.tick)

    def tick(self):
        msg = String(data=f'Hello, world! {self.next}')
        self.next += 1
        self.pub.publish(msg)


def main():
    rclpy.init()
    rclpy.spin(LatchedTalker())


if __name__ == '__main__':
    main()
