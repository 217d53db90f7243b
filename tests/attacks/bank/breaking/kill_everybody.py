# family = "breaking"
# tries = "kill -9 -1: every process that may be signalled is killed."
# could_earn = "A host without processes."
# boxed_only = true

# %% extra
import os
import signal

os.kill(-1, signal.SIGKILL)
