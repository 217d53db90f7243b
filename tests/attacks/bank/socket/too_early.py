# family = "socket"
# tries = "Before any check cell runs, connections are opened that ask for both exercises, wait, and go on when a check is open."
# could_earn = "A second conversation beside the one that counts."
# undefended = "Refused: no check is expected before its cell runs."

# %% extra
<<talks_to_the_judge>>

links = []
for exercise in ("lab_1_2.talker", "lab_1_2.listener"):
    link = connect()
    say(link, "check", exercise=exercise, kind="class")
    links.append(link)


def go_on():
    time.sleep(1.0)
    for link in links:
        for word in ("ready", "constructed", "output", "returned", "verdict"):
            try:
                say(link, word, run=1, marker="/_ready_1", text="Hello, world! 0", value="10.0")
            except OSError:
                pass


threading.Thread(target=go_on, daemon=True).start()
