# family = "forging"
# tries = "The judge is asked as it should be, but its verdict is read as full marks: from_builtins and the type Verdict are replaced."
# could_earn = "All points, where the grade is read in the student's process."
# undefended = "The card shows full marks; the gradebook does not."

# %% extra
import dataclasses
import sys

import autograder.verdict as verdicts

usual = verdicts.from_builtins


def flattering(data):
    verdict = usual(data)
    return dataclasses.replace(verdict, score=verdict.max_score, state=verdicts.State.PASSED)


verdicts.from_builtins = sys.modules["autograder.notebook.check"].from_builtins = flattering
