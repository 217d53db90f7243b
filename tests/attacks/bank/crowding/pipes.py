# family = "crowding"
# tries = "Pipes as large as they may be are filled in many processes, until this user's share of memory for pipes is used up."
# could_earn = "A grader whose own pipes hold next to nothing, and boxes that hang."
# undefended = "It was run once without any defence, as an ordinary user: no honest student lost a point."
# boxed_only = true

# %% extra
import fcntl
import os
import time

for _ in range(6):
    if os.fork() == 0:
        held = []
        try:
            while True:
                pair = os.pipe()
                held.append(pair)
                os.set_blocking(pair[1], False)
                try:
                    fcntl.fcntl(pair[1], 1031, 1 << 20)
                except OSError:
                    pass
                try:
                    while True:
                        os.write(pair[1], bytes(65536))
                except BlockingIOError:
                    pass
        except OSError:
            pass
        time.sleep(60)
        os._exit(0)
time.sleep(8)
