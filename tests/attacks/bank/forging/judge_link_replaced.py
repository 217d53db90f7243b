# family = "forging"
# tries = "JudgeLink is replaced by one that talks to nobody and hears a verdict of full marks."
# could_earn = "All points, where the notebook's end of the conversation is believed."
# undefended = "The card shows full marks; the gradebook does not."

# %% extra
import sys

import msgspec

import autograder.notebook.checking.judge_link
from autograder.messages.judge_messages import Judged
from autograder.verdict import Verdict


class Flatterer:
    def __init__(self): self.asked = ""
    def say(self, message): self.asked = getattr(message, "exercise", self.asked)
    def close(self): pass

    def hear(self):
        verdict = {
            "exercise": self.asked, "title": "Well done", "state": "passed", "score": 10.0, "max_score": 10.0,
            "criteria": [], "timeline": [],
        }
        return Judged(msgspec.convert(verdict, type=Verdict))


autograder.notebook.checking.judge_link.JudgeLink = Flatterer
sys.modules["autograder.notebook.checking.check"].JudgeLink = Flatterer
