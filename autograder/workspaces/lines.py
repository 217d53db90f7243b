"""Messages as JSON lines over a Unix socket, between processes that need not trust each other."""

from __future__ import annotations

import contextlib
import json
import socket
import threading
from typing import TYPE_CHECKING, Any, Self

if TYPE_CHECKING:
    from pathlib import Path

MAX_LINE = 1_000_000
"""Bytes of one message; a longer one ends the conversation."""


class Hangup(ConnectionError):
    """The other side is gone, or said something that is no message."""


class Lines:
    """One conversation. Any thread may say something; one listens."""

    def __init__(self, connection: socket.socket) -> None:
        self._socket = connection
        self._buffer = bytearray()
        self._lock = threading.Lock()

    @classmethod
    def to(cls, path: Path | str, limit: float | None = None) -> Self:
        """Call somebody.

        Args:
            path: Their socket.
            limit: Seconds of wall time that each wait may take; None for any.

        Raises:
            Hangup: Nobody is there.
        """
        connection = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        connection.settimeout(limit)
        try:
            connection.connect(str(path))
        except OSError as error:
            connection.close()
            raise Hangup(str(error)) from error
        return cls(connection)

    def say(self, word: str, **rest: Any) -> None:
        """Say one thing.

        Raises:
            Hangup: Nobody listens any more.
        """
        line = json.dumps({"say": word, **rest}).encode() + b"\n"
        try:
            with self._lock:
                self._socket.sendall(line)
        except OSError as error:
            raise Hangup(str(error)) from error

    def hear(self) -> dict[str, Any]:
        """Wait for the next message.

        Raises:
            Hangup: They hung up, said too much at once, or something that is no message.
        """
        searched = 0
        while (end := self._buffer.find(b"\n", searched)) < 0:
            searched = len(self._buffer)
            if searched > MAX_LINE:
                raise Hangup("a message is too long")
            try:
                chunk = self._socket.recv(1 << 16)
            except OSError as error:
                raise Hangup(str(error)) from error
            if not chunk:
                raise Hangup("the other side hung up")
            self._buffer += chunk
        line = bytes(self._buffer[:end])
        del self._buffer[: end + 1]
        try:
            message = json.loads(line)
        except (ValueError, RecursionError) as error:
            raise Hangup(f"not a message: {error}") from error
        if not isinstance(message, dict) or not isinstance(message.get("say"), str):
            raise Hangup("not a message")
        return message

    def close(self) -> None:
        """Hang up; who waits in :meth:`hear` is told."""
        with contextlib.suppress(OSError):
            self._socket.shutdown(socket.SHUT_RDWR)
        self._socket.close()
