# lab_1_2.listener: subscribes with another type.

# %% solution ListenerNode
from std_msgs.msg import Int32


class ListenerNode(Node):
    def __init__(self) -> None:
        super().__init__("listener_node")
        self.sub = self.create_subscription(Int32, "chatter", self.heard, 10)

    def heard(self, msg):
        self.get_logger().info(f"I heard: {msg.data}")
