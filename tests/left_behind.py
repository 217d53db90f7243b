"""Ends a command in its middle and says what is left of it: ``python -m tests.left_behind SIGNAL WORD COMMAND...``.

The signal is sent once a process below the command has ``WORD`` in its command line: ``SIGINT`` to the whole group, as
a terminal does, the others to the command alone. This program makes itself the parent of whatever loses its own, so
that nothing gets out of sight, whatever session and environment it has given itself.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time

from autograder.process_trees import adopt_orphans, reaped
from tests.nothing_left import below, end_all

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
        # The first process of a box ends only when all that was in it has been reaped (pid_namespaces(7)).
        reaped(process.pid)
        time.sleep(0.05)
    for pid, line in left.items():
        print(f"left: {pid} {line}")
    end_all()
    return len(left)


if __name__ == "__main__":
    sys.exit(min(1, main(*sys.argv[1:])))
