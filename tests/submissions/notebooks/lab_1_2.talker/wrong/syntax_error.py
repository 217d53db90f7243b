# lab_1_2.talker: a bracket is missing, so the cell does not run and there is no TalkerNode.

# %% solution TalkerNode
class TalkerNode(Node):
    def __init__(self) -> None:
        super().__init__("talker_node"
        self.count = 0
        self.pub = self.create_publisher(String, "chatter", 10)
        self.timer = self.create_timer(0.5, self.tick)
