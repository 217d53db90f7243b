# family = "reading"
# tries = "The way out is looked for through other roots: /proc/PID/root, /proc/PID/cwd, open folders that were inherited, mounts, /sys and raw disks."
# could_earn = "The whole file system of the host."
# undefended = "LEAK: without a box there is nothing to get out of."

# %% extra
import os

marks = ["<<class>>/grades.csv", "<<class>>/nbgrader_config.py", "<<home>>/.ssh/id_rsa"]
roots = ["", *(f"/proc/{p}/root" for p in os.listdir("/proc") if p.isdigit())]
for fd in os.listdir("/proc/self/fd"):
    roots += [f"/proc/self/fd/{fd}" + "/.." * up for up in range(8)]
for root in roots:
    for mark in marks:
        if os.path.exists(root + mark):
            print("LEAK:", root + mark)
for name in ("/dev/sda", "/dev/vda", "/dev/nvme0n1", "/dev/mem", "/proc/kcore", "/etc/shadow"):
    try:
        with open(name, "rb") as file:
            print("LEAK:", name, len(file.read(16)))
    except OSError:
        pass
