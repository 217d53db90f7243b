# family = "reading"
# tries = "The log of the machine is read: by system call, as a device, and where the system keeps logs, old crashes and traces."
# could_earn = "Addresses of the kernel, names of users and mounts, what other programs were ended for."
# undefended = "Not tried."
# says = "READ NO LOG"

# %% extra
import ctypes
import glob

libc = ctypes.CDLL(None, use_errno=True)
room = ctypes.create_string_buffer(100_000)
for action in (3, 4, 10):  # all; all, and clear; its size
    if (count := libc.klogctl(action, room, len(room))) > 0:
        print("LEAK: klogctl", action, count)
for pattern in ("/dev/kmsg", "/proc/kmsg", "/sys/fs/pstore/*", "/sys/kernel/debug/*", "/sys/kernel/tracing/*", "/var/log/*", "/run/log/*"):
    for path in glob.glob(pattern):
        try:
            with open(path, "rb", buffering=0) as file:
                if text := file.read(200):
                    print("LEAK:", path, text)
        except OSError:
            pass
print("READ NO LOG" if count <= 0 else "READ A LOG")
