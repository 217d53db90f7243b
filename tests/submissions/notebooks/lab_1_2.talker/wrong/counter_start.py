# lab_1_2.talker: partly right; counts up before it publishes, so it begins with 1.

# %% solution TalkerNode
class TalkerNode(Node):
    def __init__(self) -> None:
        super().__init__("talker_node")
        self.count = 0
        self.pub = self.create_publisher(String, "chatter", 10)
        self.timer = self.create_timer(0.5, self.tick)

    def tick(self):
        self.count += 1
        self.pub.publish(String(data=f"Hello, world! {self.count}"))
