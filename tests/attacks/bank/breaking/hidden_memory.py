# family = "breaking"
# tries = "The kernel and its children hide their memory from whoever looks at processes (PR_SET_DUMPABLE), and then take twice as much as a box may have."
# could_earn = "A machine without memory."
# undefended = "It was run once without the defence, as an ordinary user, and was ended all the same: it has not been seen to succeed."
# boxed_only = true

# %% extra
import ctypes
import os
import time

ctypes.CDLL(None).prctl(4, 0)
for _ in range(12):
    if os.fork() == 0:
        hoard = bytearray(os.urandom(1000) * 120_000)
        time.sleep(600)
        os._exit(0)
time.sleep(7)
print("LEAK:", "nobody ended it")
