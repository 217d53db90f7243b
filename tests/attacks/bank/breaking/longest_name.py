# family = "breaking"
# tries = "The talker is right, but its name is so long that no parameter service of it can exist."
# could_earn = "A judge that ends without a verdict; a right answer that has no points."
# earned = { "lab_1_2.talker" = 10 }
# undefended = "The judge asked for a service whose name was too long, and ended with code 1."

# %% right TalkerNode

# %% behind TalkerNode
from rclpy.parameter import Parameter

Usual, Bare = TalkerNode, Node.__init__


class TalkerNode(Usual):
    def __init__(self):
        no_description = Parameter("start_type_description_service", value=False)
        Node.__init__ = lambda node, _: Bare(
            node, "n" * 250, start_parameter_services=False, parameter_overrides=[no_description]
        )
        try:
            super().__init__()
        finally:
            Node.__init__ = Bare
