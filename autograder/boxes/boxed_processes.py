"""The processes of a box, seen from who has started them: a fork of a fork server, or a command."""

from __future__ import annotations

import contextlib
import os
import select
import signal
import time
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Self

from autograder.boxes.box import ANSWER_SECONDS
from autograder.boxes.channel import Channel, ChannelClosed
from autograder.process_trees import signal_group

if TYPE_CHECKING:
    from collections.abc import Sequence

    from autograder.boxes.box import Box
    from autograder.boxes.entering import Entrance

_START_SECONDS = 60.0
_CLOSING_SECONDS = 10.0
"""Seconds from the end of a command's output to its own."""
_ITS_TIME = 1e6
"""Seconds, more than any check lasts: a program runs as long as the judge wants it to."""


class ForkedProcess:
    """A process that a fork server has forked for us.

    It is killed when this object's channel is closed, in whatever way.

    Args:
        address: Where the fork server listens.
        entrance: How the process begins.
        descriptors: What it is given. They stay open here.
        box: The box that it enters and ends with; None where it is in none.

    Raises:
        ChannelClosed: The fork server is gone, or the child could not enter its box.
    """

    def __init__(
        self, address: str, entrance: Entrance, descriptors: Sequence[int], box: Box | None = None
    ) -> None:
        self._box = box
        self._channel = Channel.to(address)
        self._status: int | None = None
        self._lost = False
        try:
            self._channel.send(asdict(entrance), [*([box.pidfd] if box else []), *descriptors])
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
        """True if who watched over it is gone, or its box went away under it: then its end says nothing of it."""
        self._look(0.0)
        return self._lost or (self._box is not None and self._box.lost)

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

    def end_box(self) -> None:
        """Kill all that is in its box, and keep its status."""
        if self._box is not None:
            with contextlib.suppress(OSError):
                self._box.end()

    def end(self) -> None:
        """Kill it, and with its box all that it has started; may be called twice."""
        self.end_box()
        if self._channel.fileno() < 0:
            return
        if self.alive:
            with contextlib.suppress(ProcessLookupError):
                os.kill(self.pid, signal.SIGKILL)
            self.wait(_START_SECONDS)
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


@dataclass(frozen=True)
class Finished:
    """The end of a command in a box.

    Attributes:
        returncode: As :class:`subprocess.Popen` has it: the exit code; negative for a signal. None where it was
            ended at its limit.
        output: What it said on standard output and standard error, in that order of arrival, at most the allowed
            number of bytes.
        cut: Whether it said more.
    """

    returncode: int | None
    output: bytes
    cut: bool


class Running:
    """A command that runs in a box; leaving the context ends it and all that it has started."""

    def __init__(self, box: Box, output: int, most: int) -> None:
        self._box, self._output, self._most = box, output, most
        self._began = time.monotonic()
        self._kept = bytearray()
        self._cut = False
        self.pid = box.pid
        """The first process of the box, as the host counts."""

    def read(self, within: float) -> bool:
        """Take up what it says; False once it has ended.

        Args:
            within: Seconds to wait for something to read.
        """
        piece = self.next_output(max(0.0, within))
        if piece is None:
            return True
        room = self._most - len(self._kept)
        self._kept += piece[:room]
        self._cut = self._cut or len(piece) > room
        return bool(piece)

    @property
    def said(self) -> bytes:
        """Its output so far, as far as it was read and is kept."""
        return bytes(self._kept)

    def wait(self, limit: float) -> Finished:
        """Wait until it ends, and end it at its limit.

        Args:
            limit: Seconds of wall time from its start.
        """
        deadline = self._began + limit
        running = True
        while running and time.monotonic() < deadline:
            running = self.read(deadline - time.monotonic())
        if running:
            self._box.end()
        returncode = None if running else _returncode(self._box.wait_end())
        return Finished(returncode, self.said, self._cut)

    def next_output(self, within: float) -> bytes | None:
        """Its output since the last call, which is not kept; None for nothing yet, no bytes at its end.

        Args:
            within: Seconds to wait for something.
        """
        if not select.select([self._output], [], [], within)[0]:
            return None
        return os.read(self._output, 1 << 16)

    def exit_code(self) -> int | None:
        """Wait for the end of the box, once there is no more output; as ``Finished.returncode``."""
        return self.wait(_ITS_TIME).returncode

    def interrupt(self) -> None:
        """Ctrl-C, as a terminal sends it: to all of the process group at once.

        One after the other, a program might have ended, and `ros2 run` with it, before Ctrl-C came to `ros2 run`. The
        first process of the box, which leads the group, takes no notice: it has no handler (pid_namespaces(7)).
        """
        signal_group(self.pid, signal.SIGINT)

    def end(self) -> None:
        """Kill it and all that it has started; may be called twice."""
        if self._output >= 0:
            self._box.end()
            os.close(self._output)
            self._output = -1

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.end()


class WarmCommand:
    """A command that a fork server has forked into a box of its own.

    Args:
        process: The command; its box ends with it.
        output: What it says, readable.
        pid: The first process of the box, as the host counts.
    """

    def __init__(self, process: ForkedProcess, output: int, pid: int) -> None:
        self._process, self._output, self.pid = process, output, pid

    def next_output(self, within: float) -> bytes | None:
        """See :meth:`Running.next_output`. What the command has started and left ends with it."""
        process = self._process.fileno()
        ready = select.select([self._output, process], [], [], within)[0]
        if process in ready:
            self._process.end_box()  # what is left of it may hold its output, or say more without end
        return os.read(self._output, 1 << 16) if ready else None

    def exit_code(self) -> int | None:
        """Its exit code, once there is no more output; as ``Finished.returncode``, None where nobody can tell it."""
        if not self._process.wait(_CLOSING_SECONDS):
            self._process.end_box()  # it has closed its output and goes on, where nobody could end it any more
            self._process.wait(ANSWER_SECONDS)
        status = self._process.status
        if status is None:
            return None
        code = os.waitstatus_to_exitcode(status)
        return _returncode(code) if code >= 0 else code

    def interrupt(self) -> None:
        """Ctrl-C, as a terminal sends it to all of a process group."""
        self._process.interrupt()

    def end(self) -> None:
        """Kill it and all that it has started; may be called twice."""
        if self._output >= 0:
            self._process.end()
            os.close(self._output)
            self._output = -1


def _returncode(status: int) -> int:
    """As :class:`subprocess.Popen` has it, where a signal's number comes as 128 and more."""
    return status if status < 128 else 128 - status
