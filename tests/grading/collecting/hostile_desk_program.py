"""A program in the place of the desk's own: what an archive could do that has taken it over. Its bytes say what."""

from __future__ import annotations

import os
import socket
from pathlib import Path
from typing import TYPE_CHECKING, Any

from autograder.boxes import desk_program

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence


def prepare(*readers: str) -> None:
    """Be as ready as a desk."""
    desk_program.prepare(*readers)


def run(call: Mapping[str, Any], descriptors: Sequence[int]) -> None:
    """Do what the bytes of the file name, or write them as the answer."""
    source, answer = descriptors
    if call["request"] == desk_program.REHEARSAL:
        desk_program.run(call, descriptors)
        return
    data = os.pread(source, 1_000, 0)
    if data == b"reach":
        reached = ", ".join(name for name, act in _ACTS.items() if _succeeds(act))
        line = f'{{"names": ["reached"], "size": {len(reached)}}}\n{reached}'.encode()
        os.write(answer, line)
    elif data == b"too much":
        while True:
            os.write(answer, bytes(10_000_000))
    elif data == b"no memory":
        bytearray(10**9)
    elif data == b"end":
        os._exit(3)
    elif data == b"endless":
        while True:
            pass
    else:
        os.write(answer, data)


_ACTS: dict[str, Callable[[], object]] = {
    "a file": lambda: os.open("/etc/passwd", os.O_RDONLY),
    "a folder": lambda: list(Path("/").iterdir()),
    "a new file": lambda: os.open("/tmp/x", os.O_CREAT | os.O_WRONLY),
    "a program": lambda: os.execv("/bin/true", ["true"]),
    "a process": os.fork,
    "a network": lambda: socket.socket(),
    "memory": lambda: os.memfd_create("x"),
}


def _succeeds(act: Callable[[], object]) -> bool:
    try:
        act()
    except OSError:
        return False
    return True
