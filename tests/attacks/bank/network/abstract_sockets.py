# family = "network"
# tries = "Abstract Unix sockets, which belong to the network and not to the file system, are asked: one of this bank, and all that /proc/net/unix lists."
# could_earn = "Whatever they give to a local user, such as a desktop's session."
# undefended = "The trap's abstract socket was reached."

# %% extra
import socket

names = {line.split()[-1][1:] for line in open("/proc/net/unix") if line.split()[-1].startswith("@")}
for name in {"<<abstract>>", *names}:
    try:
        with socket.socket(socket.AF_UNIX) as link:
            link.settimeout(1.0)
            link.connect(f"\0{name}")
            if name == "<<abstract>>":
                link.sendall(b"abstract_sockets")
                print("LEAK: connected to", name)
    except OSError:
        pass
