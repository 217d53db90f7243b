"""A box, and the conversation with its supervisor in which it is made and ended."""

from __future__ import annotations

import threading
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from autograder.boxes.channel import Channel, ChannelClosed, close_all

if TYPE_CHECKING:
    from collections.abc import Sequence

ANSWER_SECONDS = 30.0
"""Seconds of wall time in which the supervisor of the boxes answers."""


class NoSandbox(RuntimeError):
    """There is no box here; the message says why, and what to do about it."""


@dataclass(frozen=True)
class Box:
    """A box that is there.

    Attributes:
        name: Its name among the boxes of its supervisor.
        pid: Its first process, as the host counts.
        pidfd: Stands for that process: hand it to a fork server to enter the box. Belongs to the supervision; -1 for a
            command that has ended at once.
        guarded: What enters it has the limits of the guard.
        supervision: Ends it.
    """

    name: str
    pid: int
    pidfd: int
    guarded: bool
    supervision: Supervision

    @property
    def lost(self) -> bool:
        """True if its supervisor is gone, and the box with it: then no end of a process says anything."""
        return self.supervision.lost

    def end(self) -> int:
        """Kill the box and wait until no process of it is alive; may be called twice.

        Returns:
            The exit code of bubblewrap: that of the command, 128 and more for a signal.

        Raises:
            ChannelClosed: The supervisor is gone.
        """
        return self.supervision.end(self.name)

    def wait_end(self) -> int:
        """Wait until the box has ended of its own; as :meth:`end`.

        Raises:
            ChannelClosed: It did not end in time, or the supervisor is gone.
        """
        return self.supervision.wait_end(self.name)


class Supervision:
    """A conversation with a supervisor of its own. Threads take turns.

    Args:
        supervisors: Where the fork server of supervisors listens.
        words: What :mod:`autograder.boxes.supervisor` is to know of the scratch.

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

    def start(
        self, name: str, descriptors: Sequence[int] = (), *, guarded: bool = False, **words: Any
    ) -> Box:
        """Make a box.

        Args:
            name: Not yet used here.
            descriptors: Standard input, output and error of its command, where it has one; they stay open here.
            guarded: See :class:`Box`.
            words: What the supervisor is to know of the box.

        Raises:
            NoSandbox: It could not be made.
        """
        with self._turn:
            message, received = self._ask("started", descriptors, say="start", name=name, **words)
            pidfd = received[0] if received else -1
            box = self._boxes[name] = Box(name, message["pid"], pidfd, guarded, self)
        return box

    @property
    def lost(self) -> bool:
        """True if the supervisor is gone, and all boxes with it."""
        return self._channel.hung_up

    def end(self, name: str) -> int:
        """Implements :meth:`Box.end`."""
        with self._turn:
            if name not in self._ended:
                self._channel.send({"say": "kill", "name": name})
            return self.wait_end(name)

    def wait_end(self, name: str) -> int:
        """Implements :meth:`Box.wait_end`."""
        with self._turn:
            while name not in self._ended:
                self._take(*self._channel.receive(ANSWER_SECONDS))
            box = self._boxes.pop(name, None)
            if box is not None:
                close_all([box.pidfd])
            return self._ended[name]

    def close(self) -> None:
        """End all boxes and wait until none of their processes is alive; may be called twice."""
        try:
            for name in list(self._boxes):
                self.end(name)
        except ChannelClosed:
            pass  # the supervisor is gone, and with it what it kept
        finally:
            self._channel.close()
            close_all([box.pidfd for box in self._boxes.values()])
            self._boxes.clear()

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
            raise NoSandbox(f"the supervisor of the boxes is gone: {error}") from error

    def _take(self, message: dict[str, Any], descriptors: Sequence[int]) -> None:
        close_all(descriptors)
        if message["say"] == "ended":
            self._ended[message["name"]] = message["status"]
        elif message["say"] == "failed":
            raise NoSandbox(message["why"])
