# family = "crowding"
# tries = "Descriptors are watched by descriptors that watch, a quarter of a million pairs a process, until the system allows this user no more of them."
# could_earn = "Everybody else's kernels: none can begin to wait for a message."
# undefended = "Without the limit on all open files it was run once, as an ordinary user: no honest student lost a point, so it has not been seen to succeed."
# boxed_only = true

# %% extra
import os
import select
import time

for _ in range(26):
    if os.fork() == 0:
        watchers, watched = [], []
        try:
            while len(watchers) < 480:
                watchers.append(select.epoll())
            while len(watched) < 480:
                watched.append(os.eventfd(0))
        except OSError:
            pass
        try:
            for watcher in watchers:
                for descriptor in watched:
                    watcher.register(descriptor, select.EPOLLIN)
        except OSError:
            pass
        time.sleep(60)
        os._exit(0)
time.sleep(8)
