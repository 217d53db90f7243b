"""The words between a notebook and the judge: JSON lines over a Unix socket.

The notebook's side is untrusted. Whatever it says only affects what the subject is taken to have said or done
on its
own account; what happens on the wire the judge sees for itself.

Notebook to judge: ``check``, ``ready``, ``constructed``, ``raised``, ``callback_raised``, ``returned``,
``output``,
``stopped``. Judge to notebook: ``begin``, ``start``, ``release``, ``stop``, ``verdict``.
"""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import msgspec

if TYPE_CHECKING:
    import socket

MAX_LINE = 1_000_000
"""Bytes of one message; a longer one ends the conversation."""
VERSION = 1


class LinkClosed(ConnectionError):
    """The other side is gone or does not speak this language."""


class Link:
    """One conversation."""

    def __init__(self, connection: socket.socket) -> None:
        self._socket = connection
        self._buffer = bytearray()

    def send(self, say: str, **words: Any) -> None:
        """Say one thing.

        Raises:
            LinkClosed: Nobody listens any more.
        """
        line = msgspec.json.encode({"say": say, **words}) + b"\n"
        try:
            self._socket.sendall(line)
        except OSError as error:
            raise LinkClosed(str(error)) from error

    def receive(self) -> dict[str, Any]:
        """Wait for the next message.

        Raises:
            LinkClosed: The other side hung up, said too much at once or something that is not a message.
        """
        while (end := self._buffer.find(b"\n")) < 0:
            if len(self._buffer) > MAX_LINE:
                raise LinkClosed("a message is too long")
            try:
                chunk = self._socket.recv(65536)
            except OSError as error:
                raise LinkClosed(str(error)) from error
            if not chunk:
                raise LinkClosed("the other side hung up")
            self._buffer += chunk
        line = bytes(self._buffer[:end])
        del self._buffer[: end + 1]
        return _message(line)

    def close(self) -> None:
        """Hang up."""
        self._socket.close()


def _message(line: bytes) -> dict[str, Any]:
    try:
        message = json.loads(line)
    except (ValueError, RecursionError) as error:
        raise LinkClosed(f"not a message: {error}") from error
    if not isinstance(message, dict) or not isinstance(message.get("say"), str):
        raise LinkClosed("not a message")
    return message
