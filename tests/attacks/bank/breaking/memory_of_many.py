# family = "breaking"
# tries = "Thirty processes take 400 MB each, each of them modest by itself."
# could_earn = "A host without memory, past a limit that holds for one process."
# boxed_only = true

# %% extra
import subprocess
import sys
import time

HOARD = "import time; hoard = bytearray(b'x') * 400_000_000; time.sleep(60)"
for _ in range(30):
    subprocess.Popen([sys.executable, "-S", "-c", HOARD, "<<mark>>"])
time.sleep(4)
