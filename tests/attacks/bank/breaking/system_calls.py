# family = "breaking"
# tries = "System calls that nobody needs for a node and that ways out of containers began with: bpf, userfaultfd, keyctl, perf_event_open, ptrace of a sibling, kexec_load, the host's name, the clock, priorities."
# could_earn = "A hole of the kernel of the host."
# boxed_only = true

# %% extra
import ctypes
import os
import platform
import time

libc = ctypes.CDLL(None, use_errno=True)
done = []
if platform.machine() == "x86_64":
    calls = {"bpf": 321, "userfaultfd": 323, "keyctl": 250, "add_key": 248, "perf_event_open": 298, "kexec_load": 246,
             "init_module": 175, "open_by_handle_at": 304, "setns": 308, "reboot": 169, "swapon": 167, "acct": 163}
    for name, number in calls.items():
        if libc.syscall(number, 0, 0, 0, 0, 0, 0) >= 0:
            done.append(name)
try:
    time.clock_settime(time.CLOCK_REALTIME, time.time() + 0.001)
    done.append("clock")
except OSError:
    pass
if libc.sethostname(b"x", 1) == 0:
    done.append("hostname")
try:
    os.setpriority(os.PRIO_PROCESS, 0, -10)
    done.append("priority")
except OSError:
    pass
print("LEAK:" if done else "nothing", done)
