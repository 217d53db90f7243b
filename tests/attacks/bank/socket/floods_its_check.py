# family = "socket"
# tries = "Within the check's own conversation, words flood the judge: as many lines of output as go through in four seconds, each with other texts."
# could_earn = "A judge that runs out of memory or time, in the hope that this is a pass."
# undefended = "What a subject says is cut at a limit; the check ends without points."

# %% solution ListenerNode
import threading
import time

import autograder.notebook.checking.judge_link as judge_link
from autograder.messages.run_messages import Output, Start


class ListenerNode(Node):
    def __init__(self):
        super().__init__("listener_node")


usual = judge_link.JudgeLink.hear


def hear(self):
    word = usual(self)
    if isinstance(word, Start):
        def flood(until=time.monotonic() + 4.0):
            number = 0
            while time.monotonic() < until:
                number += 1
                self.say(Output(word.run, f"amber birch {number} " * 200))

        threading.Thread(target=flood, daemon=True).start()
    return word


judge_link.JudgeLink.hear = hear
