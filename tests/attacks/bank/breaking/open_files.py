# family = "breaking"
# tries = "Files, sockets and pipes are opened until the host has no more."
# could_earn = "A grader that cannot open its files."
# undefended = "The kernel comes to the limit of its own process."

# %% extra
import os
import socket

held = []
try:
    while len(held) < 2_000_000:
        held += os.pipe()
        held.append(socket.socket())
except OSError as error:
    print(len(held), error)
