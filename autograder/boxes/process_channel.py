"""Messages between the grader's own processes: JSON and file descriptors over a Unix socket.

The messages can be trusted, because no process in a box holds an end of such a socket. Each message is one packet, so
it always arrives complete.
"""

from __future__ import annotations

import contextlib
import json
import os
import select
import socket
from typing import TYPE_CHECKING, Any, Self

if TYPE_CHECKING:
    from collections.abc import Sequence


LARGEST = 200_000
"""The maximum size of a message in bytes. Linux by default allows slightly more in a packet."""
_MOST_DESCRIPTORS = 32


class ChannelClosed(ConnectionError):
    """The other end of the connection has closed it or has ended."""


class Channel:
    """One end of a connection."""

    def __init__(self, connection: socket.socket) -> None:
        self._socket = connection

    @classmethod
    def to(cls, address: str) -> Self:
        """Connect to a process that listens on a socket.

        Args:
            address: The path of the socket.

        Raises:
            ChannelClosed: No process listens on this socket.
        """
        connection = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        try:
            connection.connect(address)
        except OSError as error:
            connection.close()
            raise ChannelClosed(f"no process listens on {address}: {error}") from error
        return cls(connection)

    def fileno(self) -> int:
        """Return the descriptor that becomes readable when a message has come or the other end has closed."""
        return self._socket.fileno()

    def send(self, message: dict[str, Any], descriptors: Sequence[int] = ()) -> None:
        """Send one message. The caller's copies of the descriptors stay open.

        Raises:
            ChannelClosed: The other end has closed.
        """
        try:
            socket.send_fds(self._socket, [json.dumps(message).encode()], list(descriptors))
        except OSError as error:
            raise ChannelClosed(str(error)) from error

    def receive(self, within: float | None = None) -> tuple[dict[str, Any], list[int]]:
        """Wait for a message.

        Args:
            within: The maximum number of seconds to wait; None to wait without limit.

        Returns:
            The message, and the descriptors that came with it, which the caller now owns.

        Raises:
            ChannelClosed: The other end has closed, or sent nothing in time.
        """
        if within is not None and not select.select([self._socket], [], [], within)[0]:
            raise ChannelClosed(f"no answer within {within:g} s")
        try:
            data, descriptors, _, _ = socket.recv_fds(self._socket, LARGEST, _MOST_DESCRIPTORS)
        except OSError as error:
            raise ChannelClosed(str(error)) from error
        if not data:
            close_all(descriptors)
            raise ChannelClosed("the other end has closed the connection")
        for descriptor in descriptors:
            os.set_inheritable(descriptor, False)
        message: dict[str, Any] = json.loads(data)
        return message, descriptors

    @property
    def hung_up(self) -> bool:
        """True if the other end has closed, even if messages from it are still unread."""
        if self._socket.fileno() < 0:
            return False
        poll = select.poll()
        poll.register(self._socket, 0)
        return bool(poll.poll(0))

    def hang_up(self) -> None:
        """End the connection for both ends. Any thread may call this, even while another thread waits for a message."""
        with contextlib.suppress(OSError):
            self._socket.shutdown(socket.SHUT_RDWR)

    def close(self) -> None:
        """Close the connection. This may be called twice."""
        self._socket.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def close_all(descriptors: Sequence[int]) -> None:
    """Close descriptors that are no longer needed."""
    for descriptor in descriptors:
        with contextlib.suppress(OSError):
            os.close(descriptor)
