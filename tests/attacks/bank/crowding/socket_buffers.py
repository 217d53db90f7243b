# family = "crowding"
# tries = "Sockets that nobody reads are filled, in many processes: what waits in them belongs to no process, and is seen by nobody who counts the memory of processes."
# could_earn = "The machine's memory."
# undefended = "Not run without the defence: it would take the machine's memory."
# boxed_only = true

# %% extra
import os
import socket
import time

for _ in range(8):
    if os.fork() == 0:
        held = []
        try:
            while True:
                a, b = socket.socketpair()
                held.append((a, b))
                for end in (a, b):
                    end.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, 200_000)
                    end.setblocking(False)
                    try:
                        while True:
                            end.send(bytes(100_000))
                    except BlockingIOError:
                        pass
        except OSError:
            pass
        time.sleep(60)
        os._exit(0)
time.sleep(8)
