# family = "reading"
# tries = "Descriptors of every process in sight are copied with pidfd_getfd, and read where they are files."
# could_earn = "An open store of the class, a notebook of a neighbour, the judge's socket."
# undefended = "LEAK: pidfd_getfd copies a descriptor of a sibling of the same user."

# %% extra
import ctypes
import os
import subprocess

libc = ctypes.CDLL(None, use_errno=True)
PIDFD_OPEN, PIDFD_GETFD = 434, 438
sleeping = subprocess.Popen(["sleep", "5"])
for process in map(int, filter(str.isdigit, os.listdir("/proc"))):
    held = libc.syscall(PIDFD_OPEN, process, 0)
    for number in range(40 if held >= 0 and process != os.getpid() else 0):
        copied = libc.syscall(PIDFD_GETFD, held, number, 0)
        if copied >= 0:
            print("LEAK: a descriptor of", process, os.readlink(f"/proc/self/fd/{copied}"))
sleeping.kill()
