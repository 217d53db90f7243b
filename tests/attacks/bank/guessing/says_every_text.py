# family = "guessing"
# tries = "The listener says as many texts as it can that the judge might send, without looking at what arrives."
# could_earn = "The points for saying what was heard."
# earned = { "lab_1_2.listener" = 3 }
# undefended = "There are 3.6 million texts, and six to be hit in time: no point was earned so, but the judge was kept busy for a minute."

# %% solution ListenerNode
from itertools import product

<<listeners_texts>>
WORDS = _WORDS


class ListenerNode(Node):
    def __init__(self):
        super().__init__("listener_node")
        self.create_subscription(String, "chatter", lambda message: None, 10)
        self.texts = (f"{a} {b} {n}" for n in range(1000, 10000) for a, b in product(WORDS, WORDS))
        self.create_timer(0.02, self.guess)

    def guess(self):
        for _ in range(20):
            print(" ".join(next(self.texts) for _ in range(200)))
