# family = "wire"
# tries = "Messages on the topic are bytes that are no message of its type: a length of four gigabytes, no end, invalid UTF-8, nothing at all."
# could_earn = "A judge that breaks down over them, in the hope that this is a pass."
# earned = { "lab_1_2.talker" = 3 }
# undefended = "The judge's node ended with an error: zero points, but the grader's trouble."

# %% solution TalkerNode
import struct

ODD = (
    b"\x00\x01\x00\x00" + struct.pack("<I", 0xFFFFFFFF) + b"Hello",
    b"\x00\x01\x00\x00" + struct.pack("<I", 1000) + b"Hello\x00",
    b"\x00\x01\x00\x00" + struct.pack("<I", 6) + b"\xff\xfe\xed\xc0\x80\x00",
    b"\x00\x01\x00\x00",
    b"\xff" * 40,
)


class TalkerNode(Node):
    def __init__(self):
        super().__init__("talker_node")
        self.publisher_ = self.create_publisher(String, "chatter", 10)
        self.count = 0
        self.create_timer(0.03, self.say_hello)

    def say_hello(self):
        self.publisher_.publish(ODD[self.count % len(ODD)])
        self.count += 1
