# lab_1_2.talker: sys.exit() before the class, left over from a program; there is no TalkerNode.

# %% solution TalkerNode
import sys

if len(sys.argv) != 1:
    sys.exit("usage: talker.py")


class TalkerNode(Node):
    def __init__(self) -> None:
        super().__init__("talker_node")
        self.count = 0
        self.pub = self.create_publisher(String, "chatter", 10)
        self.timer = self.create_timer(0.5, self.tick)

    def tick(self):
        self.pub.publish(String(data=f"Hello, world! {self.count}"))
        self.count += 1
