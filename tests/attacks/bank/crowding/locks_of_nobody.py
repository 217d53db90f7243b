# family = "crowding"
# tries = "Parts of files are locked so that /proc/locks shows of no box whose locks they are: locks of an open file description, and those of a process that shares its table of open files with another one and ends."
# could_earn = "The machine's memory."
# undefended = "LEAK: 5000 and 5000 locks, of which the box's /proc/locks named no process."
# boxed_only = true

# %% extra
import ctypes
import fcntl
import os
import platform
import signal
import struct

libc = ctypes.CDLL(None, use_errno=True)
CLONE = {"x86_64": 56, "aarch64": 220}[platform.machine()]
CLONE_FILES = 0x400
F_OFD_SETLK = 37


def lock(name, command):
    count = 0
    try:
        for part in reversed(range(5000)):
            fcntl.fcntl(name, command, struct.pack("hhqqi4x", fcntl.F_WRLCK, 0, 2 * part, 1, 0))
            count += 1
    except OSError:
        pass
    return count


first, second = open("first", "w+"), open("second", "w+")
reading, writing = os.pipe()
child = libc.syscall(CLONE, CLONE_FILES | signal.SIGCHLD, 0, 0, 0, 0)
if child == 0:
    os.write(writing, b"%d" % lock(second, fcntl.F_SETLK))
    os._exit(0)
of_the_file = lock(first, F_OFD_SETLK)
of_the_dead = int(os.read(reading, 100)) if child > 0 else 0
print("LEAK:" if of_the_file or of_the_dead else "none", of_the_file, "and", of_the_dead, "locks")
