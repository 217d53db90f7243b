# family = "crowding"
# tries = "The first thread of each process ends, so that Linux shows a zombie without memory and files. Its other thread goes on and takes both."
# could_earn = "Memory and open files without a limit, on a host without control groups."
# undefended = "The guard counted none of 900 MB in three processes, and none of their files."
# boxed_only = true

# %% extra
import ctypes
import os
import platform
import threading
import time

EXIT = {"x86_64": 60, "aarch64": 93}[platform.machine()]


def hoards():
    time.sleep(0.2)
    held = [bytearray(os.urandom(1000) * 300_000), [os.eventfd(0) for _ in range(900)]]
    time.sleep(60)


for _ in range(8):
    if os.fork() == 0:
        threading.Thread(target=hoards).start()
        ctypes.CDLL(None).syscall(EXIT, 0)
time.sleep(8)
