# family = "wire"
# assignment = "lab_1_1"
# could_earn = "The points for a node and a line that the package does not have: whoever is stopped is woken."
# earned = { "lab_1_1.hello" = 3 }
# at_most = true
# tries = "The kernel speaks for the package, and forty processes in sessions of their own send SIGCONT to everybody in a loop, in case the notebook is stopped meanwhile."
# undefended = "Ten points, as long as the notebook's processes were stopped one after the other."

# %% solution files
<<silent_package>>
import os
import signal

for _ in range(40):
    if os.fork() == 0:
        os.setsid()
        while True:
            os.kill(-1, signal.SIGCONT)
            time.sleep(0.001)
<<speaks_for_it>>
