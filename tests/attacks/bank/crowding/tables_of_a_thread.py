# family = "crowding"
# tries = "A thread gets a table of open files of its own, which no folder of its process shows: by close_range, and by clone without CLONE_FILES."
# could_earn = "Open files, pipes and watches that no guard counts."
# undefended = "LEAK: close_range gave a thread a table of its own."
# boxed_only = true

# %% extra
import ctypes
import os
import threading

libc = ctypes.CDLL(None, use_errno=True)


def hides():
    if libc.syscall(436, 1000, 1001, 2) == 0:  # close_range with CLOSE_RANGE_UNSHARE
        held = os.eventfd(0)
        shown = os.listdir(f"/proc/{os.getpid()}/fd")
        print("LEAK: hidden" if str(held) not in shown else "LEAK: unshared")
    else:
        print("none", ctypes.get_errno())


thread = threading.Thread(target=hides)
thread.start()
thread.join()
