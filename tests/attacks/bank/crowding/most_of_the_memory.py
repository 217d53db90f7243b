# family = "crowding"
# tries = "A right answer with 600 MB of memory in six processes: less than one box may have, and more than there is for all boxes at once if each takes as much."
# could_earn = "A machine without memory, where the system ends whatever is largest: a grader, or an honest student's kernel."
# earned = { "lab_1_2.talker" = 10, "lab_1_2.listener" = 10 }
# undefended = "24 boxes at once were reckoned with 250 MB each and could have 2 GB each."
# boxed_only = true

# %% extra
import os
import time

for _ in range(6):
    if os.fork() == 0:
        hoard = bytearray(100_000_000)
        hoard[::4096] = bytes([1]) * len(hoard[::4096])
        time.sleep(600)
        os._exit(0)
time.sleep(2)

# %% right TalkerNode
# %% right ListenerNode
