"""Messages as JSON lines over a Unix socket, between processes that need not trust each other."""

from __future__ import annotations

import contextlib
import json
import os
import select
import socket
import sys
import threading
import time
from typing import TYPE_CHECKING, Any, Self, TypeVar, overload

import msgspec

if TYPE_CHECKING:
    from pathlib import Path
    from types import UnionType

MAX_LINE = 1_000_000
"""Bytes of one message; a longer one ends the conversation."""


class Hangup(ConnectionError):
    """The other side is gone, or said something that is no message."""


class Silent(Hangup):
    """The other side said nothing in time."""


class TooLong(Hangup):
    """The other side said more at once than is listened to."""


class NotUnderstood(ValueError):
    """The other side said something that is a message, but none that is expected here."""


def _tag(name: str) -> str:
    """The word on the wire for a type: ``callback_raised`` for ``CallbackRaised``."""
    return "".join(f"_{c.lower()}" if c.isupper() and i else c.lower() for i, c in enumerate(name))


class Message(msgspec.Struct, frozen=True, tag_field="say", tag=_tag):
    """One message. The name of its type is the word in its field ``say``."""


MessageT = TypeVar("MessageT", bound=Message)


class Lines:
    """One conversation. Any thread may say something; one listens.

    Args:
        connection: One end of a Unix socket; belongs to this object from now on.
        largest: Bytes of one message that are listened to.
    """

    def __init__(self, connection: socket.socket, largest: int = MAX_LINE) -> None:
        self._socket, self._largest = connection, largest
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

    @classmethod
    def with_parent(cls, largest: int = sys.maxsize) -> Self:
        """Speak with whoever has started this process with a socket as its standard input.

        No child of this process inherits that socket: so the end of the conversation is the end of this process.
        """
        connection = socket.socket(fileno=os.dup(0))
        nothing = os.open(os.devnull, os.O_RDONLY)
        os.dup2(nothing, 0)
        os.close(nothing)
        return cls(connection, largest)

    def say(self, message: Message) -> None:
        """Say one thing.

        Raises:
            Hangup: Nobody listens any more.
        """
        self._send(encode(message))

    def say_json(self, line: bytes) -> None:
        """Say one thing that is JSON already, in one line.

        Raises:
            Hangup: Nobody listens any more.
        """
        self._send(line + b"\n")

    def _send(self, data: bytes) -> None:
        try:
            with self._lock:
                self._socket.sendall(data)
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
        words = _words(self.hear_json())
        try:
            return msgspec.convert(words, type=kind)
        except (msgspec.ValidationError, ValueError) as error:
            raise NotUnderstood("this message is not expected here") from error

    def hear_json(self, within: float | None = None) -> bytes:
        """Wait for the next message, and leave it as it came.

        Args:
            within: Seconds of wall time; None for any.

        Raises:
            Silent: They did not say it in time.
            TooLong: They said too much at once.
            Hangup: They hung up.
        """
        deadline = None if within is None else time.monotonic() + within
        searched = 0
        while (end := self._buffer.find(b"\n", searched)) < 0:
            searched = len(self._buffer)
            if searched > self._largest:
                raise TooLong("a message is too long")
            if deadline is not None and not self._readable(deadline):
                raise Silent("the other side said nothing in time")
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

    def _readable(self, deadline: float) -> bool:
        waiting = select.poll()
        waiting.register(self._socket, select.POLLIN)
        return bool(waiting.poll(max(0.0, deadline - time.monotonic()) * 1000))

    def finish(self) -> None:
        """Say nothing more, from any thread; what the others still say can be heard."""
        with contextlib.suppress(OSError):
            self._socket.shutdown(socket.SHUT_WR)

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
