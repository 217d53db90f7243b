# family = "socket"
# tries = "check connects and says nothing, or asks and then answers nothing, until the cell's time is nearly up."
# could_earn = "A judge that waits for ever, and a batch that does not end."
# undefended = "The judge stops waiting; zero points."

# %% extra
<<talks_to_the_judge>>


def check(exercise, subject):
    link = connect()
    if exercise == "lab_1_2.talker":
        time.sleep(3.0)
        return 10.0
    say(link, "check", exercise=exercise, kind="class")
    link.recv(1000)
    time.sleep(3.0)
    return 10.0
