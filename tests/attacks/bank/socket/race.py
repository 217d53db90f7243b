# family = "socket"
# tries = "Eight threads race the check to the judge's socket, so that one of them is taken for it; whoever wins says what a listener would say."
# could_earn = "The place of the check, and points for words."
# undefended = "One of them is taken for the check and earns what is seen on the wire: nothing."

# %% extra
<<talks_to_the_judge>>


def race():
    for _ in range(200):
        try:
            link = connect()
            say(link, "check", exercise="lab_1_2.listener", kind="function")
            answer = json.loads(link.makefile().readline())
            if answer["say"] == "begin":
                say(link, "ready")
                for _ in range(50):
                    say(link, "output", run=1, text='I heard: "amber birch 1234"')
                say(link, "returned", run=1, value="10.0")
                return
        except (OSError, ValueError):
            time.sleep(0.01)


for _ in range(8):
    threading.Thread(target=race, daemon=True).start()
