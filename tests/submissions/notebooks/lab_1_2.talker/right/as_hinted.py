# lab_1_2.talker: the hinted way, with an f-string and a line in the log.

# %% solution TalkerNode
class TalkerNode(Node):
    """Says "Hello, world! N" on the topic chatter every 0.5 s; N counts up from 0."""

    def __init__(self) -> None:
        super().__init__("talker_node")
        self.count = 0
        self.pub = self.create_publisher(String, "chatter", 10)
        self.timer = self.create_timer(0.5, self.tick)

    def tick(self):
        msg = String()
        msg.data = f"Hello, world! {self.count}"
        self.pub.publish(msg)
        self.get_logger().info(f"published {msg.data}")
        self.count += 1
