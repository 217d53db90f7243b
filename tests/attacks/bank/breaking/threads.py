# family = "breaking"
# tries = "Twenty thousand threads are started in one process."
# could_earn = "A host that can start no more of them."
# boxed_only = true

# %% extra
import threading

gate = threading.Event()
count = 0
try:
    while count < 20_000:
        threading.Thread(target=gate.wait, daemon=True).start()
        count += 1
except RuntimeError as error:
    print(count, error)
gate.set()
