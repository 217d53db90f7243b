# family = "crowding"
# tries = "UDP sockets that nobody reads are filled: what waits in them belongs to no process, and on many hosts to no cgroup. All boxes share the machine's limit for it, and beyond that DDS hears nothing."
# could_earn = "The machine's memory, and zeros for others."
# undefended = "Not run without the defence: it would take the memory of the machine's sockets."
# boxed_only = true

# %% extra
import os
import socket
import time

for _ in range(4):
    if os.fork() == 0:
        held = []
        try:
            for _ in range(900):
                end = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
                end.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 10**8)
                end.bind(("127.0.0.1", 0))
                held.append(end)
                for _ in range(100):
                    end.sendto(bytes(8000), end.getsockname())
        except OSError:
            pass
        time.sleep(60)
        os._exit(0)
time.sleep(8)
