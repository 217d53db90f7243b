# family = "socket"
# tries = "The right exercise is asked for, and then every word holds what no text can be written with: lone surrogates, numbers without end, control characters, in output, tracebacks and return values."
# could_earn = "A verdict that cannot be written down, in the hope that this is a pass, or that the batch ends."
# undefended = "The judge ended with an error before it had a verdict; zero points, but the grader's trouble."

# %% extra
<<talks_to_the_judge>>

ODD = "\ud800\udfff\x00\x1b[2J" * 50


def check(exercise, subject):
    link = connect()
    say(link, "check", exercise=exercise, kind="class")
    for line in link.makefile(errors="replace"):
        word = json.loads(line)
        if word["say"] == "begin":
            say(link, "ready")
        elif word["say"] == "start":
            run = word["run"]
            say(link, "constructed", run=run, marker=ODD)
            say(link, "output", run=run, text=ODD)
            say(link, "exited", run=run, code=10**300)
            say(link, "callback_raised", run=run, traceback="Traceback (most recent call last):\n  " + ODD)
            say(link, "raised", run=run, value=ODD, traceback="Traceback (most recent call last):\nValueError: " + ODD)
        elif word["say"] == "stop":
            say(link, "stopped", run=word["run"])
        elif word["say"] in ("verdict", "refused"):
            return 10.0
