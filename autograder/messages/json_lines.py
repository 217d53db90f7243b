"""Exchanges messages as JSON lines over a Unix socket, between processes that need not trust each other."""

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
"""The maximum size of a message in bytes. A longer message ends the connection."""


class Hangup(ConnectionError):
    """The other side has disconnected, or sent something that is not a message."""


class Silent(Hangup):
    """The other side sent nothing in time."""


class TooLong(Hangup):
    """The other side sent a message that is too long."""


class NotUnderstood(ValueError):
    """The other side sent a message of a type that is not expected."""


def _tag(name: str) -> str:
    """Return the word in JSON for a type of message, such as ``callback_raised`` for ``CallbackRaised``."""
    return "".join(f"_{c.lower()}" if c.isupper() and i else c.lower() for i, c in enumerate(name))


class Message(msgspec.Struct, frozen=True, tag_field="say", tag=_tag):
    """A message. The field ``say`` in its JSON contains the word for its type."""


MessageT = TypeVar("MessageT", bound=Message)


class Lines:
    """One connection for messages. Any thread may send, but only one thread may receive.

    Args:
        connection: A connected Unix socket. Closing this object closes the socket.
        largest: The maximum size of a received message, in bytes.
    """

    def __init__(self, connection: socket.socket, largest: int = MAX_LINE) -> None:
        self._socket, self._largest = connection, largest
        self._buffer = bytearray()
        self._lock = threading.Lock()

    @classmethod
    def to(cls, path: Path | str, limit: float | None = None) -> Self:
        """Connect to a listening Unix socket.

        Args:
            path: The path of the socket.
            limit: Time limit for each sending and receiving, in seconds of wall time; None for no limit.

        Raises:
            Hangup: No process accepts the connection.
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
    def with_parent(cls) -> Self:
        """Connect to the parent process, which started this process with a socket as its standard input.

        Children of this process get an empty standard input instead. So the connection ends when this process ends.
        """
        connection = socket.socket(fileno=os.dup(0))
        nothing = os.open(os.devnull, os.O_RDONLY)
        os.dup2(nothing, 0)
        os.close(nothing)
        return cls(connection, sys.maxsize)

    def say(self, message: Message) -> None:
        """Send one message.

        Raises:
            Hangup: The other side has disconnected.
        """
        self._send(encode(message))

    def say_json(self, line: bytes) -> None:
        """Send one message that is already a line of JSON.

        Raises:
            Hangup: The other side has disconnected.
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
            kind: The expected type of the message, or a union of types.

        Raises:
            Hangup: The other side has disconnected, or sent something that is too long or not a message.
            NotUnderstood: The message has another type.
        """
        words = _words(self.hear_json())
        try:
            return msgspec.convert(words, type=kind)
        except (msgspec.ValidationError, ValueError) as error:
            raise NotUnderstood("the other side sent a message of a type that is not expected") from error

    def hear_json(self, within: float | None = None) -> bytes:
        """Wait for the next message, and return its line of JSON without decoding it.

        Args:
            within: The limit in seconds of wall time; None for no limit.

        Raises:
            Silent: No message came in time.
            TooLong: The message is too long.
            Hangup: The other side has disconnected.
        """
        deadline = None if within is None else time.monotonic() + within
        searched = 0
        while (end := self._buffer.find(b"\n", searched)) < 0:
            searched = len(self._buffer)
            if searched > self._largest:
                raise TooLong("a message is too long")
            if deadline is not None and not self._readable(deadline):
                raise Silent("the other side sent no message in time")
            try:
                chunk = self._socket.recv(1 << 16)
            except OSError as error:
                raise Hangup(str(error)) from error
            if not chunk:
                raise Hangup("the other side disconnected")
            self._buffer += chunk
        line = bytes(self._buffer[:end])
        del self._buffer[: end + 1]
        return line

    def _readable(self, deadline: float) -> bool:
        waiting = select.poll()
        waiting.register(self._socket, select.POLLIN)
        return bool(waiting.poll(max(0.0, deadline - time.monotonic()) * 1000))

    def finish(self) -> None:
        """Stop sending. Any thread may call this. Messages can still be received."""
        with contextlib.suppress(OSError):
            self._socket.shutdown(socket.SHUT_WR)

    def close(self) -> None:
        """Close the connection. A thread that waits in :meth:`hear` gets a Hangup."""
        with contextlib.suppress(OSError):
            self._socket.shutdown(socket.SHUT_RDWR)
        self._socket.close()


def listen(path: Path) -> socket.socket:
    """Return a listening Unix socket that only this user can reach. A file at this path is replaced.

    Args:
        path: The path of the socket, at most 107 bytes long (unix(7)).
    """
    listener = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    path.unlink(missing_ok=True)
    listener.bind(str(path))
    path.chmod(0o600)
    listener.listen(16)
    return listener


def encode(message: Message) -> bytes:
    """Return a message as bytes, with a newline at the end.

    Lone surrogates, which Python uses in file names that are not UTF-8, are sent as JSON escapes. msgspec alone would
    reject them, and a student's output that contains one would end the check.
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
    """Return a plain string for a value that msgspec does not know, such as one of a class derived from ``str``."""
    return str.__str__(value) if isinstance(value, str) else str(value)
