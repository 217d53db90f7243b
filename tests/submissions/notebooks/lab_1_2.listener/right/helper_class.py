# lab_1_2.listener: an extra cell holds a base class; the solution is a subclass of it.

# %% extra
class ChatterNode(Node):
    """A node that hands on the text of each message on chatter."""

    def __init__(self, name):
        super().__init__(name)
        self.texts = []
        self.create_subscription(String, "chatter", self._receive, 10)

    def _receive(self, msg):
        self.texts.append(msg.data)
        self.received(msg.data)

# %% solution ListenerNode
class ListenerNode(ChatterNode):
    def __init__(self):
        super().__init__("listener_node")

    def received(self, text):
        self.get_logger().warn("%d: %s" % (len(self.texts), text))
