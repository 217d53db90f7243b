# family = "network"
# tries = "A way out of the host is looked for: an interface other than loopback, a route to an outside address, raw packets."
# could_earn = "Solutions from outside, or the inputs sent there."
# undefended = "LEAK: without a box, the host's interfaces and routes are there."

# %% extra
import socket

names = [line.split(":")[0].strip() for line in open("/proc/net/dev").readlines()[2:]]
if set(names) != {"lo"}:
    print("LEAK:", names)
for family, address in ((socket.AF_INET, "192.0.2.1"), (socket.AF_INET6, "2001:db8::1")):
    try:
        # Connecting a datagram socket sends nothing: it only asks for the route.
        with socket.socket(family, socket.SOCK_DGRAM) as probe:
            probe.connect((address, 9))
            print("LEAK: a route to", address)
    except OSError:
        pass
for family in (socket.AF_PACKET, socket.AF_INET):
    try:
        socket.socket(family, socket.SOCK_RAW, socket.IPPROTO_ICMP).close()
        print("LEAK: raw sockets of family", family)
    except OSError:
        pass
