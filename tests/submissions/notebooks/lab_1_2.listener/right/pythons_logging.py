# lab_1_2.listener: right, with Python's own logging, whose handler keeps the stream that it found when its cell was run.

# %% solution ListenerNode
import logging

logging.basicConfig(level=logging.INFO)
log = logging.getLogger("listener")


class ListenerNode(Node):
    def __init__(self):
        super().__init__("listener_node")
        self.create_subscription(String, "chatter", self.hear, 10)

    def hear(self, msg):
        log.info("I heard: %s", msg.data)
