# family = "breaking"
# tries = "A second node publishes the first and the last moments that a time can have on /clock, and the talker's node is told to follow it."
# could_earn = "A judge that computes with times out of range, and ends."
# undefended = "Zero points: the talker's own timer jumps."
# earned = { "lab_1_2.talker" = 10 }
# at_most = true

# %% right TalkerNode

# %% behind TalkerNode
import rclpy
from builtin_interfaces.msg import Time
from rosgraph_msgs.msg import Clock

Usual = TalkerNode


class TalkerNode(Usual):
    def __init__(self):
        super().__init__()
        self.other = rclpy.create_node("clock", context=self.context)
        self.clocks = self.other.create_publisher(Clock, "/clock", 10)
        self.moments = [(2**31 - 1, 999_999_999), (-(2**31), 0), (0, 2**32 - 1), (-1, 4_000_000_000)]
        self.create_timer(0.1, self.lie)

    def lie(self):
        for seconds, nanoseconds in self.moments:
            self.clocks.publish(Clock(clock=Time(sec=seconds, nanosec=nanoseconds)))
