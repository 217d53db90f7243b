# family = "socket"
# tries = "A process that outlives the check cell asks for the talker again and again, with a talker that works, after its check is over."
# could_earn = "The talker's points after its time, or the judge's attention during the listener's check."
# undefended = "Refused: a check counts while its cell runs, and once."

# %% extra
import subprocess
import sys

LATER = r'''
<<talks_to_the_judge>>

for _ in range(40):
    time.sleep(0.05)
    try:
        link = connect()
        say(link, "check", exercise="lab_1_2.talker", kind="class")
        link.recv(1000)
        say(link, "ready")
    except OSError:
        pass
'''

# %% solution ListenerNode
subprocess.Popen([sys.executable, "-S", "-c", LATER, "<<mark>>"], start_new_session=True)


class ListenerNode(Node):
    pass
