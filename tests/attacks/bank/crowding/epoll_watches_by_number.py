# family = "crowding"
# tries = "epoll counts a watch for each pair of a file and a descriptor's number: numbers are made to mean another file again and again, until the user has no watches left."
# could_earn = "Everybody else's kernels: none can begin to wait for a message. And a gigabyte of the kernel's memory."
# undefended = "As an ordinary user all 5.5 million watches were in one box after 36 s; a ZeroMQ context and asyncio failed in every other process of the user."
# boxed_only = true

# %% extra
import os
import select
import time

for _ in range(4):
    if os.fork() == 0:
        watchers, kept = [select.epoll() for _ in range(40)], []
        try:
            while True:
                kept.append(os.eventfd(0))
                for number in range(300, 1000):
                    os.dup2(kept[-1], number)
                for watcher in watchers:
                    for number in range(300, 1000):
                        watcher.register(number, 0)
        except OSError:
            pass
        time.sleep(60)
        os._exit(0)
time.sleep(50)
