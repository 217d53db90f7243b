"""What holds for every test."""

from __future__ import annotations

import signal

# Started in the background of a shell without job control, a process ignores Ctrl-C, and so does all that it starts
# (POSIX, "Asynchronous Lists"). Tests send SIGINT to what they start.
if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)
