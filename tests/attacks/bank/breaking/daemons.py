# family = "breaking"
# tries = "Daemons are left behind: forked twice, in sessions of their own, with another name and an empty environment, deaf to every signal that can be ignored."
# could_earn = "A process that lives on, in other submissions' time."
# undefended = "Found and killed as a descendant of the worker."

# %% extra
import os
import signal
import subprocess
import sys

DAEMON = """
import os, signal, sys, time
for number in range(1, 32):
    try:
        signal.signal(number, signal.SIG_IGN)
    except (OSError, ValueError):
        pass
for _ in range(2):
    if os.fork():
        os._exit(0)
    os.setsid()
open(f"/proc/{os.getpid()}/comm", "w").write("<<mark>>")
time.sleep(900)
"""
for _ in range(3):
    subprocess.run([sys.executable, "-S", "-c", DAEMON, "<<mark>>"], env={}, cwd="/")
