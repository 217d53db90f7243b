# family = "forging"
# tries = "The judge is asked as it should be, but its verdict is read as full marks: what hears the messages of the judge is replaced."
# could_earn = "All points, where the grade is read in the student's process."
# undefended = "The card shows full marks; the gradebook does not."

# %% extra
import dataclasses

import msgspec

import autograder.notebook.checking.judge_link as judge_link
from autograder.verdict import State

usual = judge_link.JudgeLink.hear


def flattering(self):
    message = usual(self)
    if not hasattr(message, "verdict"):
        return message
    verdict = dataclasses.replace(message.verdict, score=message.verdict.max_score, state=State.PASSED)
    return msgspec.structs.replace(message, verdict=verdict)


judge_link.JudgeLink.hear = flattering
