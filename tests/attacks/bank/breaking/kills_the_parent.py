# family = "breaking"
# tries = "The kernel's parent and its parents, and its own process group, are killed: the first process of its box, the worker, the grader."
# could_earn = "A batch that ends, or a submission that escapes its box."
# boxed_only = true

# %% extra
import os
import signal

for number in (signal.SIGTERM, signal.SIGKILL):
    for process in (os.getppid(), 1):
        try:
            os.kill(process, number)
        except OSError as error:
            print(error)
os.killpg(0, signal.SIGKILL)
