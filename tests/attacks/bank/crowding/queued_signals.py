# family = "crowding"
# tries = "Signals that are blocked are queued, and timers made, until this user may queue no more: the number is one for all processes of a user."
# could_earn = "Everybody else's timers."
# undefended = "LEAK: 96,364 signals and timers of the user's 96,365 were in one box."
# boxed_only = true

# %% extra
import ctypes
import os
import signal

libc = ctypes.CDLL(None, use_errno=True)
count = 0
reading, writing = os.pipe()
if os.fork() == 0:
    signal.pthread_sigmask(signal.SIG_BLOCK, range(34, 65))
    while count < 200_000 and libc.sigqueue(os.getpid(), 40, None) == 0:
        count += 1
    event = (ctypes.c_int * 16)(0, 0, 40, 0)
    timer = ctypes.c_void_p()
    while count < 200_000 and libc.timer_create(1, event, ctypes.byref(timer)) == 0:
        count += 1
    os.write(writing, b"%d" % count)
    signal.pause()
count = int(os.read(reading, 100))
print(f"LEAK: {count} signals and timers" if count > 20_000 else count)
