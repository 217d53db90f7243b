"""The grader's connections to the processes that make its boxes: messages, supervisors and boxes.

A message is JSON and file descriptors, and can be trusted, because no process in a box holds an end of such a
connection. Each message is one packet, so it always arrives complete.
"""

from __future__ import annotations

import contextlib
import json
import os
import select
import socket
import threading
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Self

if TYPE_CHECKING:
    from collections.abc import Sequence

_LARGEST = 200_000
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
            data, descriptors, _, _ = socket.recv_fds(self._socket, _LARGEST, _MOST_DESCRIPTORS)
        except OSError as error:
            raise ChannelClosed(str(error)) from error
        if not data:
            close_all(descriptors)
            raise ChannelClosed("the other end has closed the connection")
        # Received descriptors are inheritable at first, and would leak into each program that this process starts.
        for descriptor in descriptors:
            os.set_inheritable(descriptor, False)
        message: dict[str, Any] = json.loads(data)
        return message, descriptors

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


ANSWER_SECONDS = 30.0
"""Time limit in seconds of wall time for an answer from a supervisor."""


class NoSandbox(RuntimeError):
    """No box can be made on this machine. The exception's text gives the reason, and says what to do about it."""


@dataclass(frozen=True)
class Box:
    """A running box.

    Attributes:
        name: The name of this box, unique among the boxes of its supervisor.
        pid: The PID of the box's first process, as seen from the host.
        pidfd: A pidfd of the box's first process, which a fork server needs to enter the box; -1 for a command that
            ended at once. ``supervision`` closes it.
        guarded: True if the guard's limits apply to every process that enters the box.
        supervision: The connection to the supervisor, through which this box is ended.
    """

    name: str
    pid: int
    pidfd: int
    guarded: bool
    supervision: Supervision

    @property
    def lost(self) -> bool:
        """True if the supervisor has ended, and with it this box. An exit code then says nothing about student code."""
        return self.supervision.lost

    def end(self) -> int:
        """Kill the box, and wait until none of its processes is alive. This may be called twice.

        Returns:
            The exit code of the box's command; if a signal ended it, 128 plus the number of the signal.

        Raises:
            ChannelClosed: The box did not end in time, or the supervisor has ended.
        """
        return self.supervision.end(self.name)

    def wait_end(self) -> int:
        """Wait until the box ends by itself; otherwise like :meth:`end`."""
        return self.supervision.wait_end(self.name)


class Supervision:
    """A connection to one supervisor process, which several threads may use.

    Args:
        supervisors: The socket address of the fork server that starts supervisors.
        words: The fields of the message ``open``, such as the path and size of the scratch.

    Raises:
        NoSandbox: The supervisor could not make the namespaces.
    """

    def __init__(self, supervisors: str, **words: Any) -> None:
        self._boxes: dict[str, Box] = {}
        self._ended: dict[str, int] = {}
        self._turn = threading.RLock()
        self._channel = Channel.to(supervisors)
        try:
            self._ask("opened", say="open", **words)
        except BaseException:
            self._channel.close()
            raise

    def _start(
        self, name: str, descriptors: Sequence[int] = (), *, guarded: bool = False, **words: Any
    ) -> Box:
        """Start a box.

        Args:
            name: A name that no other box of this supervisor has.
            descriptors: Standard input, output and error for the box's command, if it has one. The caller keeps its
                own copies.
            guarded: As in :class:`Box`.
            words: The other fields of the message ``start``.

        Raises:
            NoSandbox: The supervisor could not make the box.
        """
        with self._turn:
            message, received = self._ask("started", descriptors, say="start", name=name, **words)
            pidfd = received[0] if received else -1
            box = self._boxes[name] = Box(name, message["pid"], pidfd, guarded, self)
        return box

    @property
    def lost(self) -> bool:
        """True if the supervisor has ended, even if messages from it are still unread."""
        if self._channel.fileno() < 0:
            return False
        poll = select.poll()
        poll.register(self._channel, 0)
        return bool(poll.poll(0))

    def end(self, name: str) -> int:
        with self._turn:
            if name not in self._ended:
                self._channel.send({"say": "kill", "name": name})
            return self.wait_end(name)

    def wait_end(self, name: str) -> int:
        with self._turn:
            while name not in self._ended:
                self._take(*self._channel.receive(ANSWER_SECONDS))
            box = self._boxes.pop(name, None)
            if box is not None:
                close_all([box.pidfd])
            return self._ended[name]

    def abandon(self) -> None:
        """End all boxes, but do not wait. Any thread may call this; threads that use a box see that it is lost."""
        self._channel.hang_up()

    def close(self) -> None:
        """End all boxes, and wait until none of their processes is alive. This may be called twice."""
        try:
            for name in list(self._boxes):
                self.end(name)
        except ChannelClosed:
            pass  # the supervisor has ended, and its boxes with it
        finally:
            self._channel.close()
            close_all([box.pidfd for box in self._boxes.values()])
            self._boxes.clear()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _ask(
        self, expected: str, descriptors: Sequence[int] = (), **message: Any
    ) -> tuple[dict[str, Any], list[int]]:
        try:
            with self._turn:
                self._channel.send(message, descriptors)
                while True:
                    answer, received = self._channel.receive(ANSWER_SECONDS)
                    if answer["say"] == expected:
                        return answer, received
                    self._take(answer, received)
        except ChannelClosed as error:
            raise NoSandbox(f"the supervisor of the boxes has ended: {error}") from error

    def _take(self, message: dict[str, Any], descriptors: Sequence[int]) -> None:
        close_all(descriptors)
        if message["say"] == "ended":
            self._ended[message["name"]] = message["status"]
        elif message["say"] == "failed":
            raise NoSandbox(message["why"])
