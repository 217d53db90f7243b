# lab_1_2.talker: an endless loop in the constructor; the demonstration cell never comes to its end.

# %% solution TalkerNode
class TalkerNode(Node):
    def __init__(self) -> None:
        super().__init__("talker_node")
        self.count = 0
        self.pub = self.create_publisher(String, "chatter", 10)
        while True:
            self.pub.publish(String(data=f"Hello, world! {self.count}"))
            self.count += 1
            time.sleep(0.5)
