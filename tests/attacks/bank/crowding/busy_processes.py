# family = "crowding"
# tries = "A hundred and fifty processes compute without end while the notebook waits, and while its own right answers are checked."
# could_earn = "The processors: whoever is executed beside it waits, and the class with them."
# undefended = "Four of ten such submissions held a class for more than nine minutes on two cores."
# earned = { "lab_1_2.talker" = 10, "lab_1_2.listener" = 10 }
# at_most = true
# boxed_only = true

# %% extra
import subprocess
import sys
import time

busy = [
    subprocess.Popen([sys.executable, "-S", "-c", "while True: pass", "<<mark>>"], start_new_session=True)
    for _ in range(150)
]
time.sleep(6)

# %% right TalkerNode

# %% right ListenerNode
