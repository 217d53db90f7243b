# lab_1_2.talker: right, with lines on stderr when the cell runs and at every tick; they must not cost points.

# %% solution TalkerNode
import sys

print("TalkerNode is being defined", file=sys.stderr)


class TalkerNode(Node):
    def __init__(self):
        super().__init__("loud_talker")
        self.count = 0
        self.publisher = self.create_publisher(String, "chatter", 10)
        self.create_timer(0.5, self.talk)

    def talk(self):
        self.publisher.publish(String(data="Hello, world! " + str(self.count)))
        print(f"debugging: {self.count=}", file=sys.stderr)
        self.count += 1
