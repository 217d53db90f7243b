# lab_1_2.listener: the callback is called instead of handed over.

# %% solution ListenerNode
class ListenerNode(Node):
    def __init__(self) -> None:
        super().__init__("listener_node")
        self.sub = self.create_subscription(String, "chatter", self.heard(None), 10)

    def heard(self, msg):
        if msg:
            self.get_logger().info(f"I heard: {msg.data}")
