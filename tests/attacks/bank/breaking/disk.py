# family = "breaking"
# tries = "The disk is filled wherever it can be written to."
# could_earn = "A gradebook that cannot be written."
# boxed_only = true

# %% extra
import os

written = 0
for folder in (os.getcwd(), os.environ["HOME"], "/tmp", "/dev/shm", "/var/tmp"):
    try:
        with open(f"{folder}/<<mark>>_full", "wb") as file:
            while written < 20_000_000_000:
                written += file.write(b"x" * 10_000_000)
    except OSError as error:
        print(folder, error)
print("written", written)
if written > 5_000_000_000:
    print("LEAK: no limit on disk")
