# family = "breaking"
# tries = "A listener that says lines of thousands of quotation marks, digits and brackets, so that the judge's search in them tries again and again."
# could_earn = "A judge that is busy until its time is over, a check that could not be made, and the same again at the next run."
# undefended = "79 s for 12,000 characters, \"could not be checked\", and tried anew each time."
# earned = { "lab_1_2.talker" = 10, "lab_1_2.listener" = 3 }
# at_most = true

# %% right TalkerNode

# %% solution ListenerNode
from rclpy.node import Node
from std_msgs.msg import String


class ListenerNode(Node):
    def __init__(self):
        super().__init__("listener_node")
        self.create_subscription(String, "chatter", self.heard, 10)

    def heard(self, message):
        for line in ('"' * 12_000, '"a' * 6_000, "[(1, " * 3_000, "1" * 12_000 + "x", " " * 12_000 + "File", "“" * 12_000):
            self.get_logger().info(line)
            print(line)
