# family = "reading"
# tries = "Files are opened through a ring of io_uring, which no filter of system calls looks at, and other new ways to open: openat2, open_tree, fsopen, name_to_handle_at."
# could_earn = "A way to files and mounts past the filter of the box."
# boxed_only = true
# undefended = "LEAK: without the filter, the kernel makes a ring and opens trees."

# %% extra
import ctypes
import platform

libc = ctypes.CDLL(None, use_errno=True)
RESOLVE_NOTHING, AT_FDCWD, CLONE = ctypes.create_string_buffer(24), -100, 1
calls = {
    "io_uring_setup": (425, 8, ctypes.create_string_buffer(120)),
    "open_tree": (428, AT_FDCWD, b"/", CLONE),
    "fsopen": (430, b"tmpfs", 0),
    "fspick": (433, AT_FDCWD, b"/", 0),
    "move_mount": (429, AT_FDCWD, b"/tmp", AT_FDCWD, b"/mnt", 0),
    "mount_setattr": (442, AT_FDCWD, b"/", 0, RESOLVE_NOTHING, 32),
    "pivot_root": (155, b"/tmp", b"/tmp"),
    "memfd_secret": (447, 0),
}
done = [name for name, (number, *words) in calls.items() if platform.machine() == "x86_64" and libc.syscall(number, *words) >= 0]
print("LEAK:" if done else "nothing", done)
