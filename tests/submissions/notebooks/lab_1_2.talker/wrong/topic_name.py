# lab_1_2.talker: the topic is misspelt.

# %% solution TalkerNode
class TalkerNode(Node):
    def __init__(self) -> None:
        super().__init__("talker_node")
        self.count = 0
        self.pub = self.create_publisher(String, "chater", 10)
        self.timer = self.create_timer(0.5, self.tick)

    def tick(self):
        self.pub.publish(String(data=f"Hello, world! {self.count}"))
        self.count += 1
