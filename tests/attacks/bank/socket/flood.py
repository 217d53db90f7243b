# family = "socket"
# tries = "Three hundred connections and fifty thousand words flood the judge while both checks run."
# could_earn = "A judge that breaks down, in the hope that this is a pass, or that the batch ends."
# undefended = "Refused one by one; the check ends without points."

# %% extra
<<talks_to_the_judge>>


def flood():
    for _ in range(300):
        try:
            link = connect()
            for _ in range(200):
                say(link, "output", run=1, text="x" * 1000)
        except OSError:
            time.sleep(0.01)


for _ in range(3):
    threading.Thread(target=flood, daemon=True).start()
time.sleep(0.2)
