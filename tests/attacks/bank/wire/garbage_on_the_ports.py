# family = "wire"
# tries = "Garbage and cut RTPS messages are sent to every UDP port on which a ROS participant of this host may listen."
# could_earn = "A judge that breaks down; a neighbour's check that fails."
# boxed_only = true

# %% extra
import os
import random
import socket
import threading
import time

ports = set()
for line in open("/proc/net/udp").readlines()[1:]:
    ports.add(int(line.split()[1].split(":")[1], 16))
draw = random.Random(1)


def flood(until=time.monotonic() + 6.0):
    sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    while time.monotonic() < until:
        for port in ports:
            header = b"RTPS\x02\x03\x01\x0f" + draw.randbytes(12)
            sender.sendto(header + draw.randbytes(draw.randrange(0, 300)), ("127.0.0.1", port))
        time.sleep(0.001)


threading.Thread(target=flood, daemon=True).start()
