# lab_1_2.listener: says that something came, not what.

# %% solution ListenerNode
class ListenerNode(Node):
    def __init__(self) -> None:
        super().__init__("listener_node")
        self.sub = self.create_subscription(String, "chatter", self.heard, 10)

    def heard(self, msg):
        self.get_logger().info("I heard something")
