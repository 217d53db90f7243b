# family = "wire"
# tries = "The talker keeps a wrong rate, and a second node publishes on /clock in the judge's place, twice as fast, to make it seem right."
# could_earn = "The three points for the rate."
# earned = { "lab_1_2.talker" = 7 }
# undefended = "Full marks: its timer followed the forged clock. Where somebody else publishes on /clock, the judge looks again in real time."

# %% right TalkerNode

# %% behind TalkerNode
import threading
import time

import rclpy
from rosgraph_msgs.msg import Clock

Usual = TalkerNode


class TalkerNode(Usual):
    def create_timer(self, period, callback, *args, **kwargs):
        return super().create_timer(2 * period, callback, *args, **kwargs)

    def __init__(self):
        super().__init__()
        clock = self.create_publisher(Clock, "/clock", 10)

        def forge(seconds=100.0):
            for _ in range(400):
                seconds += 0.1
                message = Clock()
                message.clock.sec, message.clock.nanosec = int(seconds), int(seconds % 1 * 1e9)
                clock.publish(message)
                time.sleep(0.002)

        threading.Thread(target=forge, daemon=True).start()

# %% solution ListenerNode
class ListenerNode(Node):
    pass
