# family = "network"
# tries = "Datagrams are sent to a UDP service on the host's loopback address, and to every multicast group that ROS uses."
# could_earn = "A way to tell somebody outside what was seen."
# undefended = "The trap's UDP service got it."

# %% extra
import socket

sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
for host in ("127.0.0.1", "127.0.0.2", "239.255.0.1"):
    try:
        sender.sendto(b"<<mark>> datagrams", (host, <<udp_port>>))
    except OSError:
        pass
