# family = "wire"
# tries = "The talker comes with two hundred endpoints and a dozen nodes, to slow the judge's look at the graph until it gives up."
# could_earn = "A check that cannot be made, in the hope that this is a pass."
# undefended = "The look takes longer and comes to its end; no points."

# %% solution TalkerNode
class TalkerNode(Node):
    def __init__(self):
        super().__init__("talker_node")
        self.others = [Node(f"crowd_{number}") for number in range(12)]
        for number in range(200):
            self.create_publisher(String, f"crowd/topic_{number}", 10)
