# family = "wire"
# tries = "A node takes the judge's own name, so that what it does is taken for the judge's, and publishes what a talker would, at a wrong pace."
# could_earn = "Points for messages in the judge's own name."
# earned = { "lab_1_2.talker" = 5 }
# undefended = "The name changes nothing about what is seen: topic, type and text are right, counter and rate are not."

# %% extra
import rclpy


def rclpy_node(name):
    return Node(name)

# %% solution TalkerNode
class TalkerNode(Node):
    def __init__(self):
        super().__init__("talker_node")
        self.twin = None
        self.publisher_ = self.create_publisher(String, "chatter", 10)
        self.create_timer(0.05, self.shout)

    def shout(self):
        judges = [name for name in self.get_node_names() if name.startswith("judge_")]
        if self.twin is None and judges:
            self.twin = rclpy_node(judges[0])
            self.twin_publisher = self.twin.create_publisher(String, "chatter", 10)
        (self.twin_publisher if self.twin else self.publisher_).publish(String(data="Hello, world! 7"))
