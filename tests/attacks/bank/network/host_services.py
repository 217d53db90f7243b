# family = "network"
# tries = "Services that listen on the host's loopback address are asked: databases, notebooks, consoles, and one that this bank has put there."
# could_earn = "Whatever they give to a local user."
# undefended = "The trap's TCP service was reached."

# %% extra
import socket

for port in (<<tcp_port>>, 22, 5432, 6379, 8888, 8786, 2375):
    for host in ("127.0.0.1", "localhost", "::1"):
        try:
            with socket.create_connection((host, port), timeout=1.0) as link:
                link.sendall(b"host_services")
                print("LEAK: connected to", port)
        except OSError:
            pass
