# family = "breaking"
# tries = "The talker makes 150 nodes that nobody spins, and that all publish on its topic: the judge waits for each of them to answer."
# could_earn = "A check that reaches its time limit in place of zero points."
# earned = { "lab_1_2.talker" = 3 }
# at_most = true
# undefended = "The nodes were asked one after the other: after 222 s the check had no verdict."

# %% solution TalkerNode
class TalkerNode(Node):
    def __init__(self):
        super().__init__("talker_node")
        self.others = [Node(f"other_{number}") for number in range(150)]
        self.publishers_ = [node.create_publisher(String, "chatter", 10) for node in self.others]
