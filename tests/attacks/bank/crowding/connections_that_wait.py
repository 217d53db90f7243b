# family = "crowding"
# tries = "Programs connect to sockets that never accept, and close: each connection waits in the kernel, 3,500 bytes that no process has open and the box's control group is not charged for."
# could_earn = "The machine's memory."
# undefended = "LEAK: 172,000 connections in 26 s and 600 MB of the kernel's memory, of which the box's control group showed 4."
# boxed_only = true

# %% extra
import socket
import time

held, count, began = [], 0, time.monotonic()
while count < 60_000 and time.monotonic() - began < 20:
    held.append(socket.socket())
    held[-1].bind((f"127.0.0.{len(held)}", 20_000 + len(held)))
    held[-1].listen(4096)
    for _ in range(4000):
        socket.create_connection(held[-1].getsockname()).close()
        count += 1
time.sleep(2)
print(f"LEAK: {count} connections")
