# family = "socket"
# tries = "The kernel claims lines of code that nobody wrote, and that a card may quote: tags, color codes, braces of a format, lines before the first, places and names of megabytes."
# could_earn = "A page with a tag; a diagnosis in the attacker's words; a judge that ends over a quotation."
# earned = { "lab_1_2.talker" = 7 }
# undefended = "The card quotes them, escaped and cut, and no point depends on them."

# %% solution TalkerNode
import autograder.notebook.checking.check as checking
from autograder.messages.judge_messages import OwnLine, OwnLines

odd = ("<script>attack_canary()</script>", "\x1b[2J\u202e\0", "{0!r:>9999}{callback}", "`x`**y** [z](javascript:attack_canary())", "q" * 20_000)
names = ("publish", "create_publisher", "create_timer", "data", "count =", "def say_hello", "Hello")
checking.own_lines_of = lambda _: OwnLines(
    [OwnLine(name, text, number, text) for name in names for text in odd for number in (-(2**31), 0, 2**53)]
)


class TalkerNode(Node):
    def __init__(self):
        super().__init__("talker_node")
        self.count = 0
        self.publisher_ = self.create_publisher(String, "chatter", 10)
        self.create_timer(1.0, self.say_hello)

    def say_hello(self):
        self.publisher_.publish(String(data=f"Hello, world! {self.count}"))
        self.count += 1
