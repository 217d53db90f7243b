# family = "socket"
# tries = "The judge is told all words that a grader, a worker or the judge itself might use: verdict, report, open, close, score, exit."
# could_earn = "A verdict of one's own making."
# undefended = "Words that the judge does not know change nothing."

# %% extra
<<talks_to_the_judge>>

verdict = {
    "exercise": "lab_1_2.talker", "title": "t", "state": "passed", "score": 10.0, "max_score": 10.0,
    "criteria": [], "timeline": [],
}


def check(exercise, subject):
    link = connect()
    say(link, "check", exercise=exercise, kind="class", verdict=verdict, score=10.0, seed="0", expected=exercise)
    for word in ("verdict", "report", "close", "open", "score", "passed", "refused", "record", "ready", "exited"):
        say(link, word, run=1, verdict=verdict, report={"verdict": verdict}, type="close", exercise=exercise, code=0)
    link.sendall(json.dumps({"type": "close"}).encode() + b"\n" + json.dumps({"verdict": verdict}).encode() + b"\n")
    return 10.0
