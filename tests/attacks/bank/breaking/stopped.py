# family = "breaking"
# tries = "The kernel stops itself with SIGSTOP, with children that are stopped as well, so that nothing answers and nothing ends."
# could_earn = "A batch that waits for ever."
# undefended = "Killed at the cell's limit; the stopped children, too."

# %% extra
import os
import signal
import subprocess
import sys

for _ in range(3):
    child = subprocess.Popen([sys.executable, "-S", "-c", "import time; time.sleep(900)", "<<mark>>"], start_new_session=True)
    os.kill(child.pid, signal.SIGSTOP)
os.kill(os.getpid(), signal.SIGSTOP)
