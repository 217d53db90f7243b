"""Right: a while loop around spin_once; the timer lives in the node, the end is a try/finally."""
import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class Talker(Node):
    period = 0.5
    text = 'Hello, world! {number}'

    def __init__(self, **options):
        super().__init__('talker', **options)
        self.number = -1
        self.out = self.create_publisher(String, 'chatter', 10)
        self.clock_tick = self.create_timer(timer_period_sec=self.period, callback=self.say)

    def say(self):
        self.number += 1
        self.out.publish(String(data=self.text.format(number=self.number)))


def main():
    rclpy.init()
    talker = Talker()
    try:
        while rclpy.ok():
            rclpy.spin_once(talker, timeout_sec=0.1)
    finally:
        talker.destroy_node()


main()
