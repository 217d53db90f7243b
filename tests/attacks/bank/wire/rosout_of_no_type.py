# family = "wire"
# tries = "The talker logs by sending bytes on /rosout that are no log message: no end, a level that nobody knows, a time before all times, text that is none."
# could_earn = "A judge that ends over what it reads there."
# earned = { "lab_1_2.talker" = 10 }
# at_most = true
# undefended = "What is no message is dropped by the middleware."

# %% right TalkerNode

# %% behind TalkerNode
import struct

from rcl_interfaces.msg import Log
from rclpy.serialization import serialize_message

Usual = TalkerNode


class TalkerNode(Usual):
    def __init__(self):
        super().__init__()
        self.odd = self.create_publisher(Log, "/rosout", 1000)
        whole = serialize_message(Log(level=255, name="talker_node", msg="Publishing: \"\x00\x1b[2J\"", line=2**32 - 1))
        self.kinds = (
            b"", b"\x00\x01\x00\x00", whole[:-7], b"\xff" * 64,
            whole[:4] + struct.pack("<iI", -(2**31), 2**32 - 1) + whole[12:],
            whole.replace(b"talker_node", b"\xff\xfe\xed\xc0\x80alker"),
        )
        self.create_timer(0.01, self.send_odd)

    def send_odd(self):
        for kind in self.kinds:
            self.odd.publish(kind)
