# family = "crowding"
# tries = "inotify instances are opened until the system gives this user no more: it has 128 for all programs of a user together."
# could_earn = "Everybody else's programs that watch a file: editors and servers of whoever grades, and other boxes."
# undefended = "LEAK: 128 of 128 instances were in one box."
# boxed_only = true

# %% extra
import ctypes

libc = ctypes.CDLL(None, use_errno=True)
held = []
for make in (lambda: libc.inotify_init1(0), libc.inotify_init, lambda: libc.fanotify_init(0x200, 0)):
    while len(held) < 1000:
        descriptor = make()
        if descriptor < 0:
            break
        held.append(descriptor)
print(f"LEAK: {len(held)} instances that watch files" if held else "none", ctypes.get_errno())
