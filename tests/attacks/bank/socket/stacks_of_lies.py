# family = "socket"
# tries = "The kernel tells stacks that nobody has, of a talker that never answers: loops at lines of forty digits, callbacks with tags for names, processor times beyond all numbers, a first one that comes after the last question."
# could_earn = "A judge that ends over a stack; a page with a tag; a right answer's points for a loop that is none."
# earned = { "lab_1_2.talker" = 3 }
# at_most = true
# undefended = "The card quotes them, escaped and cut, and no point depends on them."

# %% solution TalkerNode
from autograder.notebook.checking.subject_reports import CapturedOutput

told = iter(
    [
        ("Thread 0x1 in the loop of line " + "9" * 40 + ": {0!r} <script>attack_canary()</script>, which no line leaves (most recent call first):", 1e308),
        ('File "x", line 1 in y\n' * 20_000, -1e308),
        ('Thread (most recent call first):\n  File "<script>attack_canary()</script>", line 7 in {who}<b>\n  File "/rclpy/task.py", line 1 in __call__\n', 5e-324),
    ]
)


def stacks(self):
    return next(told, ("Thread (most recent call first):\n" * 1_000, 3.0))


CapturedOutput.stacks = stacks


class TalkerNode(Node):
    def __init__(self):
        super().__init__("talker_node")
        self.publisher_ = self.create_publisher(String, "chatter", 10)
        self.create_timer(0.5, lambda: time.sleep(600))
