"""Ends a command in its middle and says what is left of it: ``python tests/left_behind.py SIGNAL WORD COMMAND...``.

The signal is sent once a process below the command has ``WORD`` in its command line: ``SIGINT`` to the whole group, as
a terminal does, the others to the command alone. This program makes itself the parent of whatever loses its own, so
that nothing gets out of sight, whatever session and environment it has given itself.
"""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
import time

import psutil

from autograder.parent_death import adopt_orphans

PATIENCE = 180.0
"""Seconds after which a process that is still there counts as left."""


def main(name: str, word: str, *command: str) -> int:
    """The number of processes that are left; each is printed, and killed."""
    adopt_orphans()
    signal.signal(
        signal.SIGINT, signal.default_int_handler
    )  # a shell's background ignores it, and so would the command
    process = subprocess.Popen(command, stdin=subprocess.DEVNULL, start_new_session=True)
    while not any(word in line for line in below().values()):
        if process.poll() is not None:
            sys.exit(
                f"it ended with {process.returncode} before there was anything with {word!r} in its name"
            )
        time.sleep(0.02)
    number = signal.Signals[name]
    (os.killpg if number is signal.SIGINT else os.kill)(process.pid, number)
    deadline = time.monotonic() + PATIENCE
    while (left := below()) and time.monotonic() < deadline:
        process.poll()
        time.sleep(0.05)
    for pid, line in left.items():
        print(f"left: {pid} {line}")
        with contextlib.suppress(ProcessLookupError):
            os.kill(pid, signal.SIGKILL)
    return len(left)


def below() -> dict[int, str]:
    """The command line of each process below this one that lives."""
    found = {}
    for process in psutil.Process().children(recursive=True):
        with contextlib.suppress(psutil.Error):
            if process.status() != psutil.STATUS_ZOMBIE:
                found[process.pid] = " ".join(process.cmdline())
    return found


if __name__ == "__main__":
    sys.exit(min(1, main(*sys.argv[1:])))
