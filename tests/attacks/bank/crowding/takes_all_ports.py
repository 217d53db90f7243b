# family = "crowding"
# tries = "It binds every UDP port on which a ROS participant of its network could listen, and keeps them while it is checked."
# could_earn = "A judge that finds no port: a check that does not end, or that could not be made in place of one that failed."
# boxed_only = true

# %% extra
import os
import resource
import socket
import time

resource.setrlimit(resource.RLIMIT_NOFILE, (resource.getrlimit(resource.RLIMIT_NOFILE)[1],) * 2)
ports = iter(range(7400, 65536))
for _ in range(40):
    taken = []
    for port in ports:
        try:
            taken.append(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
            taken[-1].bind(("0.0.0.0", port))
        except OSError as error:
            if error.errno == 24:  # no more descriptors for this process
                break
    if os.fork() == 0:
        time.sleep(3600)
    for one in taken:
        one.close()
