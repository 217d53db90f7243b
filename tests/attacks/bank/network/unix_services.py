# family = "network"
# tries = "Sockets of the host's services in the file system are asked: containers, system bus, journal, display, name cache."
# could_earn = "Root on the host, where one of them is Docker's."
# undefended = "LEAK: as far as such services run on the host, they could be reached."

# %% extra
import glob
import os
import socket
import stat

own = os.path.dirname(os.environ["AUTOGRADER_JUDGE_SOCKET"])
patterns = ("/run/*", "/run/*/*", "/var/run/*", "/tmp/.*/*", "/tmp/*", "/tmp/*/*", "/tmp/autograder-*/*/*/*")
for name in {name for pattern in patterns for name in glob.glob(pattern)}:
    try:
        if stat.S_ISSOCK(os.stat(name).st_mode) and not name.startswith((own, os.getcwd(), os.path.dirname(own))):
            with socket.socket(socket.AF_UNIX) as link:
                link.settimeout(1.0)
                link.connect(name)
                print("LEAK: connected to", name)
    except OSError:
        pass
