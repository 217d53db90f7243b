# family = "reading"
# tries = "Memory that processes share is listed and read: /dev/shm, System V segments, message queues, keyrings."
# could_earn = "What other submissions and the judge say to each other."
# undefended = "LEAK: without a box, every node's segments lie in one /dev/shm."

# %% extra
import os

own = set()
for name in sorted(os.listdir("/dev/shm")):
    path = f"/dev/shm/{name}"
    if os.stat(path).st_mtime < os.stat("/proc/self").st_ctime - 5:
        own.add(name)
if own:
    print("LEAK: /dev/shm", len(own), "older than this kernel")
for table in ("shm", "sem", "msg"):
    rows = open(f"/proc/sysvipc/{table}").read().splitlines()[1:]
    if rows:
        print("LEAK:", table, rows[:3])
