# family = "wire"
# tries = "The talker's texts have four megabytes each and come as fast as they can."
# could_earn = "A judge, worker or grader that runs out of memory over a verdict of hundreds of megabytes."
# earned = { "lab_1_2.talker" = 3 }
# at_most = true
# undefended = "The verdict carried every text in full: what a judge writes down is cut now."

# %% solution TalkerNode
class TalkerNode(Node):
    def __init__(self):
        super().__init__("talker_node")
        self.publisher_ = self.create_publisher(String, "chatter", 10)
        self.create_timer(0.05, lambda: self.publisher_.publish(String(data="Hello, world! " + "0" * 4_000_000)))
