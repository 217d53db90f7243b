# lab_1_2.listener: the hinted way.

# %% solution ListenerNode
class ListenerNode(Node):
    """Logs every text that arrives on the topic chatter."""

    def __init__(self) -> None:
        super().__init__("listener_node")
        self.sub = self.create_subscription(String, "chatter", self.heard, 10)

    def heard(self, msg):
        self.get_logger().info(f'I heard: "{msg.data}"')
