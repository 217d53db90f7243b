"""What code that has taken over a desk tries to reach, and what of it succeeds."""

from __future__ import annotations

import contextlib
import os
import random
import resource
import signal
import socket
import threading
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

ATTEMPTS: Mapping[str, Callable[[], Any]] = {
    "a process": os.fork,
    "a thread": lambda: threading.Thread(target=print).start(),
    "a program": lambda: os.execv("/bin/true", ["true"]),
    "a file": lambda: os.open("/etc/passwd", os.O_RDONLY),
    "a folder": lambda: list(os.scandir("/")),
    "a new file": lambda: os.open("/tmp/left-for-the-next", os.O_WRONLY | os.O_CREAT),
    "memory that stays": lambda: os.memfd_create("left"),
    "a socket": socket.socket,
    "a pipe": os.pipe,
    "all processes": lambda: os.kill(-1, signal.SIGKILL),
    "its parent": lambda: os.kill(os.getppid() or 1, 0),
    "a limit": lambda: resource.setrlimit(resource.RLIMIT_CPU, (99, 99)),
    "its end": lambda: signal.signal(signal.SIGXCPU, signal.SIG_IGN),
}
"""What no desk may do."""


def reached(further: Mapping[str, Callable[[], Any]]) -> str:
    """Make all attempts, and those of one kind of desk; the names of those that succeeded."""
    found = []
    for name, attempt in {**ATTEMPTS, **further}.items():
        with contextlib.suppress(OSError, RuntimeError, ValueError):
            attempt()
            found.append(name)
    return ", ".join(found)


def mutated(document: bytes, times: int, seed: int = 1) -> Iterator[bytes]:
    """Yield a document so often, each time with other bytes in a few places."""
    chance = random.Random(seed)
    for _ in range(times):
        changed = bytearray(document)
        for _ in range(chance.randint(1, 4)):
            place = chance.randrange(len(changed))
            changed[place : place + chance.randint(0, 3)] = chance.randbytes(chance.randint(0, 3))
        yield bytes(changed)
