# family = "crowding"
# tries = "On its network it binds the one port of each ROS domain by which a judge tells others that the domain is taken."
# could_earn = "A check that could not be made, in place of one that would fail, with another try at every run."
# earned = { "lab_1_2.talker" = 10 }
# undefended = "Not checked: no domain was free."
# boxed_only = true

# %% extra
import socket

held = []
for domain in range(1, 102):
    held.append(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
    held[-1].bind(("127.0.0.1", 7400 + 250 * domain + 9))

# %% right TalkerNode
