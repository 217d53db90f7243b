# family = "network"
# tries = "Sockets of protocols that no guard counts are opened: MPTCP, SCTP and SMC, and of netlink those of the kernel's audit, firewall, device and key tables."
# could_earn = "A hole of the kernel of the host, or memory that waits in sockets that nobody sees."
# undefended = "LEAK: MPTCP and ten protocols of netlink."
# boxed_only = true

# %% extra
import socket

opened = []
for protocol in (132, 256, 262):
    try:
        socket.socket(socket.AF_INET, socket.SOCK_STREAM, protocol).close()
        opened.append(f"protocol {protocol}")
    except OSError:
        pass
for protocol in range(1, 32):
    try:
        socket.socket(socket.AF_NETLINK, socket.SOCK_RAW, protocol).close()
        opened.append(f"netlink {protocol}")
    except OSError:
        pass
socket.socket(socket.AF_NETLINK, socket.SOCK_RAW, socket.NETLINK_ROUTE).close()
print("LEAK:" if opened else "none", opened)
