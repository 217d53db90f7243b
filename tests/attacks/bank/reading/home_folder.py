# family = "reading"
# tries = "Private keys and configuration are read from the home folder of whoever grades, by its name and by HOME of other processes."
# could_earn = "Access to everything that the instructor has access to."
# undefended = "LEAK: the file was read."

# %% extra
import glob
import os

for pattern in ("<<home>>/.ssh/*", "/home/*/.ssh/*"):
    for name in glob.glob(pattern):
        try:
            print("LEAK:", name, len(open(name).read()))
        except OSError:
            pass
