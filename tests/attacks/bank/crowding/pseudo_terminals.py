# family = "crowding"
# tries = "Terminals are opened in many processes until the machine has no more: there are 3,072 for all containers together."
# could_earn = "Everybody else's lines with an exclamation mark, which IPython runs on a terminal."
# undefended = "Not run without the defence: it would take the terminals of everybody on the machine. 4,096 less 1,024 are to be had, as the system's settings say."
# boxed_only = true

# %% extra
import os
import time

reading, writing = os.pipe()
for _ in range(8):
    if os.fork() == 0:
        count = 0
        try:
            while True:
                os.openpty()
                count += 1
        except OSError:
            pass
        os.write(writing, b"%d\n" % count)
        time.sleep(60)
        os._exit(0)
time.sleep(3)
os.set_blocking(reading, False)
total = sum(map(int, os.read(reading, 1000).split()))
print(f"LEAK: {total} terminals in one box" if total > 300 else total)
time.sleep(3)
