"""Messages as JSON lines over a Unix socket, between processes that need not trust each other."""

from __future__ import annotations

import contextlib
import json
import socket
import threading
from typing import TYPE_CHECKING, Any, Self, TypeVar, overload

import msgspec

if TYPE_CHECKING:
    from pathlib import Path
    from types import UnionType

MAX_LINE = 1_000_000
"""Bytes of one message; a longer one ends the conversation."""


class Hangup(ConnectionError):
    """The other side is gone, or said something that is no message."""


class NotUnderstood(ValueError):
    """The other side said something that is a message, but none that is expected here."""


def _tag(name: str) -> str:
    """The word on the wire for a type: ``callback_raised`` for ``CallbackRaised``."""
    return "".join(f"_{c.lower()}" if c.isupper() and i else c.lower() for i, c in enumerate(name))


class Message(msgspec.Struct, frozen=True, tag_field="say", tag=_tag):
    """One message. The name of its type is the word in its field ``say``."""


MessageT = TypeVar("MessageT", bound=Message)


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

    def say(self, message: Message) -> None:
        """Say one thing.

        Raises:
            Hangup: Nobody listens any more.
        """
        line = encode(message)
        try:
            with self._lock:
                self._socket.sendall(line)
        except OSError as error:
            raise Hangup(str(error)) from error

    @overload
    def hear(self, kind: type[MessageT]) -> MessageT: ...

    @overload
    def hear(self, kind: UnionType) -> Any: ...

    def hear(self, kind: Any) -> Any:
        """Wait for the next message.

        Args:
            kind: The type of message that is expected, or a union of such types.

        Raises:
            Hangup: They hung up, said too much at once, or something that is no message.
            NotUnderstood: It is another message than the expected ones.
        """
        words = _words(self._line())
        try:
            return msgspec.convert(words, type=kind)
        except (msgspec.ValidationError, ValueError) as error:
            raise NotUnderstood("this message is not expected here") from error

    def _line(self) -> bytes:
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
        return line

    def close(self) -> None:
        """Hang up; who waits in :meth:`hear` is told."""
        with contextlib.suppress(OSError):
            self._socket.shutdown(socket.SHUT_RDWR)
        self._socket.close()


def listen(path: Path) -> socket.socket:
    """A Unix socket that this user can connect to, in place of one that an ended process has left.

    Args:
        path: At most 107 bytes long (unix(7)).
    """
    listener = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    path.unlink(missing_ok=True)
    listener.bind(str(path))
    path.chmod(0o600)
    listener.listen(16)
    return listener


def encode(message: Message) -> bytes:
    """A message as it travels, with the end of its line.

    Lone surrogates, which Python has in the names of files that are no UTF-8, travel as JSON's escapes. msgspec alone
    would refuse them, and what a student's program prints must not end its check.
    """
    return json.dumps(msgspec.to_builtins(message, enc_hook=_plain)).encode() + b"\n"


def _words(line: bytes) -> dict[str, Any]:
    try:
        words = json.loads(line)
    except (ValueError, RecursionError) as error:
        raise Hangup(f"not a message: {error}") from error
    if not isinstance(words, dict) or not isinstance(words.get("say"), str):
        raise Hangup("not a message")
    return words


def _plain(value: Any) -> str:
    """Text of a class of a student's own, derived from ``str``, is sent as the text that it holds."""
    return str.__str__(value) if isinstance(value, str) else str(value)
