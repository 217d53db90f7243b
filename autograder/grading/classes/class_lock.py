"""Locks a class, so that only one process grades it at a time, even if nbgrader started the process."""

from __future__ import annotations

import contextlib
import fcntl
import os
import socket
import threading
from dataclasses import dataclass
from datetime import datetime
from typing import TYPE_CHECKING

import msgspec

from autograder.grading.grading_errors import ClassBusy

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path
    from typing import IO


@dataclass(frozen=True)
class _Holder:
    """The process that holds the lock of a class.

    Attributes:
        pid: The process id.
        host: The name of the machine on which it runs.
        since: The local time at which the process took the lock.
    """

    pid: int
    host: str
    since: str

    def __str__(self) -> str:
        """Return a description for messages, such as ``process 123 on lab-pc, since 2026-01-31 12:00:00``."""
        where = "" if self.host == socket.gethostname() else f" on {self.host}"
        return f"process {self.pid}{where}, since {self.since}"


_own: dict[Path, _Holder] = {}
"""The locks that this process holds. They are listed because the system would let a process take the same lock twice.
"""
_changing = threading.Lock()


@contextlib.contextmanager
def held(path: Path, of: Path) -> Iterator[bool]:
    """Hold the lock of a class during the block. Yield True if the previous holder was killed.

    The lock is a POSIX record lock, which the system releases when the process ends, and which child processes do not
    inherit. The holder writes its process id and host into the file, and removes them at the end. So if a file is not
    locked but contains a process id, the holder was killed.

    Args:
        path: The lock file, which is created if it does not exist.
        of: The class, for messages.

    Raises:
        ClassBusy: Another process, which the message names, already holds the lock.
        OSError: The lock file cannot be written.
    """
    path = path.resolve()
    now = _Holder(os.getpid(), socket.gethostname(), f"{datetime.now():%Y-%m-%d %H:%M:%S}")
    with _changing:
        # A record lock does not exclude another thread of the process that holds it.
        if path in _own:
            raise ClassBusy(of, str(_own[path]))
        file = path.open("a+b")
        try:
            was_killed = _take(file, now, of)
        except BaseException:
            file.close()
            raise
        _own[path] = now
    try:
        yield was_killed
    finally:
        with _changing:
            del _own[path]
            # An empty file says to the next holder that this one ended by itself.
            file.truncate(0)
            file.close()


def _take(file: IO[bytes], holder: _Holder, of: Path) -> bool:
    try:
        fcntl.lockf(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        raise ClassBusy(of, _who(file)) from None
    was_killed = file.seek(0, os.SEEK_END) > 0
    file.truncate(0)
    file.write(msgspec.json.encode(holder))
    file.flush()
    return was_killed


def _who(file: IO[bytes]) -> str:
    """Return the description of the holder in the file; empty if the holder has not written it yet."""
    file.seek(0)
    try:
        return str(msgspec.json.decode(file.read(), type=_Holder))
    except msgspec.MsgspecError:
        return ""
