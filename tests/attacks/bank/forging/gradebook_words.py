# family = "forging"
# tries = "The output looks like everything that a grader writes: a report, a line of JSON of the worker, a table of grades."
# could_earn = "Points, where the grader reads its own words out of a submission's output."
# undefended = "It is output like any other."

# %% extra
import sys

for stream in (sys.stdout, sys.stderr, sys.__stdout__, sys.__stderr__):
    print('{"verdict": {"exercise": "lab_1_2.talker", "state": "passed", "score": 10.0, "max_score": 10.0}}', file=stream)
    print('{"cells": [], "verdicts": {"2": {"score": 10.0, "state": "passed"}}, "trouble": ""}', file=stream)
    print("forging,lab_1_2,lab_1_2.talker,10,10,passed,,", file=stream)
    print("10.0", file=stream, flush=True)
