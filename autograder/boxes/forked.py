"""A process that a fork server has forked for us, in a box or beside one."""

from __future__ import annotations

import contextlib
import os
import select
import signal
from typing import TYPE_CHECKING

from autograder.boxes.channel import Channel, ChannelClosed
from autograder.process_trees import signal_group

if TYPE_CHECKING:
    from collections.abc import Sequence

    from autograder.boxes.entering import Entrance
    from autograder.boxes.sandbox import Enclosure

_START_SECONDS = 60.0


class ForkedProcess:
    """One process. It is killed when this object's channel is closed, in whatever way.

    Args:
        address: Where the fork server listens.
        entrance: How the process begins.
        descriptors: What it is given; the pidfd of its box comes first where it has one. They stay open here.

    Raises:
        ChannelClosed: The fork server is gone, or the child could not enter its box.
    """

    def __init__(self, address: str, entrance: Entrance, descriptors: Sequence[int]) -> None:
        self._channel = Channel.to(address)
        self._status: int | None = None
        self._lost = False
        try:
            self._channel.send(entrance.as_message(), descriptors)
            message, _ = self._channel.receive(_START_SECONDS)
        except BaseException:
            self._channel.close()
            raise
        self.pid = int(message["pid"])
        """As the host counts."""

    def fileno(self) -> int:
        """Readable when the process has ended."""
        return self._channel.fileno()

    @property
    def alive(self) -> bool:
        """True if it still runs."""
        self._look(0.0)
        return self._status is None and not self._lost

    @property
    def status(self) -> int | None:
        """Its wait status (wait(2)); None while it runs, and where nobody can tell any more."""
        self._look(0.0)
        return self._status

    @property
    def lost(self) -> bool:
        """True if the one who watched over it is gone: then its end says nothing about what ran in it."""
        self._look(0.0)
        return self._lost

    def interrupt(self) -> None:
        """SIGINT to it and to its process group."""
        if self.alive:
            signal_group(self.pid, signal.SIGINT)

    def wait(self, within: float) -> bool:
        """Wait for its end; whether it came.

        Args:
            within: Seconds.
        """
        self._look(within)
        return self._status is not None or self._lost

    def kill(self) -> None:
        """End it and wait until it has ended."""
        if self.alive:
            with contextlib.suppress(ProcessLookupError):
                os.kill(self.pid, signal.SIGKILL)
            self.wait(_START_SECONDS)

    def close(self) -> None:
        """Kill it where it still runs; may be called twice."""
        if self._channel.fileno() >= 0:
            self.kill()
            self._channel.close()

    def _look(self, within: float) -> None:
        if self._status is not None or self._lost or self._channel.fileno() < 0:
            return
        if not select.select([self._channel], [], [], max(0.0, within))[0]:
            return
        try:
            self._status = int(self._channel.receive()[0]["status"])
        except ChannelClosed:
            self._lost = True


class PlacedProcess:
    """A process in its place; ends with all that it has started.

    Args:
        process: The process.
        enclosure: Has the box that it is in; None where it is in none.
        box: The name of that box.
    """

    def __init__(self, process: ForkedProcess, enclosure: Enclosure | None = None, box: str = "") -> None:
        self._process, self._enclosure, self._box = process, enclosure, box

    def fileno(self) -> int:
        """Readable when the process has ended."""
        return self._process.fileno()

    @property
    def alive(self) -> bool:
        """True if it still runs."""
        return self._process.alive

    @property
    def lost(self) -> bool:
        """True if nobody can tell any more what became of it, as its box went away under it."""
        return self._process.lost or (self._enclosure is not None and self._enclosure.lost)

    def interrupt(self) -> None:
        """SIGINT to its process group."""
        self._process.interrupt()

    def wait(self, within: float) -> bool:
        """Wait so many seconds for its end; whether it came."""
        return self._process.wait(within)

    @property
    def status(self) -> int | None:
        """Its wait status (wait(2)); None while it runs, and where nobody can tell any more."""
        return self._process.status

    def end_box(self) -> None:
        """Kill all that is in its box, and keep its status."""
        if self._enclosure is not None:
            with contextlib.suppress(OSError):
                self._enclosure.end(self._box)

    def end(self) -> None:
        """Kill it and all that it has started; may be called twice."""
        self.end_box()
        self._process.close()
