# family = "breaking"
# tries = "A million empty files are made, to leave the file system without room for another one."
# could_earn = "A gradebook that cannot be written."
# boxed_only = true

# %% extra
import os
import time

until, count = time.monotonic() + 5.0, 0
try:
    while count < 1_000_000 and time.monotonic() < until:
        os.mkdir(str(count // 5000)) if count % 5000 == 0 else None
        open(f"{count // 5000}/{count}", "w").close()
        count += 1
except OSError as error:
    print(error)
print("made", count)
