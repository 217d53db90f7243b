# family = "network"
# tries = "Names are looked up: DNS carries words out of many a box. Asked are the system's resolver and every name server that it knows."
# could_earn = "A way to tell somebody outside what was seen."
# boxed_only = true

# %% extra
import socket

try:
    print("LEAK:", socket.getaddrinfo("example.org", 80)[0][4])
except OSError as error:
    print(error)
servers = []
try:
    servers = [line.split()[1] for line in open("/etc/resolv.conf") if line.startswith("nameserver")]
except OSError:
    pass
for server in servers:
    try:
        with socket.socket(socket.AF_INET6 if ":" in server else socket.AF_INET, socket.SOCK_DGRAM) as probe:
            probe.connect((server, 53))
            print("LEAK: a route to the name server")
    except OSError:
        pass
