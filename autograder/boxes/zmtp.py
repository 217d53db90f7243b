"""A ZeroMQ connection to a kernel with a limit on what it reads: ZMTP 3.0 (https://rfc.zeromq.org/spec/23) by hand.

ZeroMQ's own library keeps a message in memory, without a limit, until its last part has come: a kernel that sends
parts for ever would fill the machine's memory, outside its box. Here each message has a limit for all its parts
together.
"""

from __future__ import annotations

import contextlib
import socket
import time
from collections import deque
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

_MORE, _LONG, _COMMAND = 1, 2, 4
_GREETING = b"\xff" + bytes(8) + b"\x7f\x03\x00" + b"NULL".ljust(20, b"\0") + bytes(32)
_READY = b"\x05READY\x0bSocket-Type"
_SUBSCRIBE_TO_ALL = b"\x01"
_PART_BYTES = 64
"""Bytes that each part counts in addition to its content."""
_AT_ONCE, _MESSAGES_AT_ONCE = 1 << 18, 100
"""Bytes to read, and messages to return, before other connections have their turn."""
_AGAIN_SECONDS = 0.015
"""Seconds before a broken connection is made again."""


class _NotZmtp(ValueError):
    """The other end does not speak ZMTP."""


class ZmtpConnection:
    """One end of a connection. It connects again when the other end breaks the connection.

    Args:
        path: The Unix socket at which the other end listens.
        kind: ``"DEALER"``, or ``"SUB"`` for everything that the other end publishes.
        most: The largest message in bytes; a larger one is read and dropped.

    Attributes:
        read: Bytes that have been read.
        dropped: Messages that were too large.
    """

    def __init__(self, path: Path, kind: str, most: int) -> None:
        self._path = str(path)
        self._kind = kind.encode()
        self._most = most
        self.read = self.dropped = 0
        self._messages: deque[list[bytes]] = deque()
        self._socket: socket.socket | None = None
        self._connect()

    @property
    def is_waiting(self) -> bool:
        """True if a whole message waits to be taken."""
        return bool(self._messages)

    @property
    def owed(self) -> int:
        """Bytes of a too large part that are still to be skipped."""
        return self._to_skip

    @property
    def wants_to_write(self) -> bool:
        """True if something that was sent is still in the buffer."""
        return bool(self._unsent)

    def fileno(self) -> int:
        """The descriptor to poll; -1 while the other end is gone."""
        if self._socket is None and time.monotonic() > self._not_before:
            self._connect()
        return -1 if self._socket is None else self._socket.fileno()

    def send(self, parts: Sequence[bytes]) -> None:
        """Send a message now, or as soon as the socket has room for it."""
        last = len(parts) - 1
        message = b"".join(_frame(part, _MORE if place < last else 0) for place, part in enumerate(parts))
        (self._unsent if self._is_ready else self._waits_for_ready).extend(message)
        self._write()

    def received(self) -> Iterator[list[bytes]]:
        """Yield the whole messages that have arrived, without waiting; of a flood only a part."""
        if not self._messages and self._socket is not None:
            try:
                self._write()
                data = self._socket.recv(_AT_ONCE)
                if not data:
                    raise ConnectionResetError
                self.read += len(data)
                self._buffer += data
                self._take_frames()
            except BlockingIOError:
                pass
            except (OSError, _NotZmtp):
                self.close()
        for _ in range(_MESSAGES_AT_ONCE):
            if not self._messages:
                return
            yield self._messages.popleft()

    def close(self) -> None:
        """Break the connection; may be called twice."""
        if self._socket is not None:
            self._socket.close()
            self._socket = None

    def _connect(self) -> None:
        self._buffer = bytearray()
        self._unsent = bytearray(_GREETING)
        self._waits_for_ready = bytearray()
        self._parts: list[bytes] = []
        self._size = self._to_skip = 0
        self._is_greeted = self._is_ready = False
        self._not_before = time.monotonic() + _AGAIN_SECONDS
        connection = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        connection.setblocking(False)
        try:
            connection.connect(self._path)
        except OSError:
            connection.close()
            return
        self._socket = connection
        self._write()

    def _write(self) -> None:
        with contextlib.suppress(OSError):  # the reading side reports a broken connection, too
            while self._unsent and self._socket is not None:
                del self._unsent[: self._socket.send(self._unsent)]

    def _take_frames(self) -> None:
        """Take whole frames from the buffer."""
        at = 0
        if not self._is_greeted:
            if len(self._buffer) < len(_GREETING):
                return
            if self._buffer[0] != 0xFF or self._buffer[10] < 3:
                raise _NotZmtp
            at = len(_GREETING)
            self._is_greeted = True
            self._unsent += _frame(_READY + len(self._kind).to_bytes(4, "big") + self._kind, _COMMAND)
        while True:
            skipped = min(self._to_skip, len(self._buffer) - at)
            self._to_skip -= skipped
            at += skipped
            head = self._head(at)
            if self._to_skip or head is None:
                break
            flags, begins, size = head
            if self._is_too_large(flags, size):
                self._to_skip, at = size, begins
            elif len(self._buffer) < begins + size:
                break
            else:
                self._take(flags, bytes(self._buffer[begins : begins + size]))
                at = begins + size
        del self._buffer[:at]
        self._write()

    def _head(self, at: int) -> tuple[int, int, int] | None:
        """Return the flags of the frame that begins here, the start of its body, and the body's size."""
        if len(self._buffer) < at + 2:
            return None
        flags = self._buffer[at]
        if not flags & _LONG:
            return flags, at + 2, self._buffer[at + 1]
        if len(self._buffer) < at + 9:
            return None
        return flags, at + 9, int.from_bytes(self._buffer[at + 1 : at + 9], "big")

    def _is_too_large(self, flags: int, size: int) -> bool:
        """True if this part is to be skipped. A part counts once: its head is not checked again."""
        if flags & _COMMAND:
            return size > self._most
        if self._size + size + _PART_BYTES <= self._most:
            return False
        self._size, self._parts = self._most, []
        if not flags & _MORE:
            self._size = 0
            self.dropped += 1
        return True

    def _take(self, flags: int, body: bytes) -> None:
        if flags & _COMMAND:
            if body.startswith(b"\x05READY") and not self._is_ready:
                self._is_ready = True
                if self._kind == b"SUB":
                    self._unsent += _frame(_SUBSCRIBE_TO_ALL, 0)
                self._unsent += self._waits_for_ready
                self._waits_for_ready = bytearray()
            return
        self._parts.append(body)
        self._size += len(body) + _PART_BYTES
        if not flags & _MORE:
            self._messages.append(self._parts)
            self._parts, self._size = [], 0


def _frame(body: bytes, flags: int) -> bytes:
    if len(body) < 256:
        return bytes((flags, len(body))) + body
    return bytes((flags | _LONG,)) + len(body).to_bytes(8, "big") + body
