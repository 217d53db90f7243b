# family = "wire"
# tries = "The talker keeps a wrong rate by its own clock. It listens to another topic in place of /clock, on which a second node of the kernel hands on the judge's time twice as fast."
# could_earn = "The three points for the rate. It does earn them: docs/security.md says so, under simulated time."
# earned = { "lab_1_2.talker" = 10 }
# at_most = true
# undefended = "In simulated time it is a talker of the right rate; only in real time it is not."

# %% right TalkerNode

# %% behind TalkerNode
from rosgraph_msgs.msg import Clock

Usual, Plain = TalkerNode, Node.__init__


class TalkerNode(Usual):
    def __init__(self):
        Node.__init__ = lambda self, name: Plain(self, name, cli_args=["--ros-args", "-r", "/clock:=/forged"])
        try:
            super().__init__()
        finally:
            Node.__init__ = Plain
        forged = Node.create_publisher(self, Clock, "forged", 10)
        self.relay = Node("relay")
        self.relay.create_subscription(Clock, "/clock", lambda message: forged.publish(twice(message)), 10)
        Node.create_timer(self, 0.01, lambda: None)
        spinning(self.relay).__enter__()

    def create_timer(self, period, callback, *args, **kwargs):
        return super().create_timer(2 * period, callback, *args, **kwargs)


def twice(message):
    total = 2 * (message.clock.sec * 10**9 + message.clock.nanosec)
    message.clock.sec, message.clock.nanosec = divmod(total, 10**9)
    return message
