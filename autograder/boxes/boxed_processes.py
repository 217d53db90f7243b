"""The processes in a box, as seen by the process that started them: a child of a fork server, or a command."""

from __future__ import annotations

import contextlib
import os
import select
import signal
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Self

from autograder.boxes.box_connection import ANSWER_SECONDS, Channel, ChannelClosed
from autograder.process_trees import signal_group

if TYPE_CHECKING:
    from collections.abc import Sequence

    from autograder.boxes.box_connection import Box
    from autograder.boxes.process_isolation import Entrance

_START_SECONDS = 60.0


class ForkedProcess:
    """A process that a fork server has forked on request.

    The forked process is killed as soon as the connection to it is closed, for example because the grader has crashed.

    Args:
        address: The socket address of the fork server.
        entrance: The settings with which the process starts.
        descriptors: File descriptors for the process. The caller keeps its own copies.
        box: The box that the process enters, and that ends with the process; None if it runs outside any box.

    Raises:
        ChannelClosed: The fork server has ended, or the child could not enter the box.
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
        """The process id, as seen from the host."""

    def fileno(self) -> int:
        """Return the descriptor that becomes readable when the process has ended."""
        return self._channel.fileno()

    @property
    def alive(self) -> bool:
        """True if the process still runs."""
        self._look(0.0)
        return self._status is None and not self._lost

    @property
    def status(self) -> int | None:
        """The wait status of the process (wait(2)); None while the process runs, or if the status is lost."""
        self._look(0.0)
        return self._status

    @property
    def lost(self) -> bool:
        """True if the supervisor or the box ended before the process, so that the process has no status of its own."""
        self._look(0.0)
        return self._lost or (self._box is not None and self._box.lost)

    def interrupt(self) -> None:
        """Send SIGINT to the process and its process group."""
        if self.alive:
            signal_group(self.pid, signal.SIGINT)

    def wait(self, within: float) -> bool:
        """Wait for the process to end. Return True if it has ended.

        Args:
            within: The maximum number of seconds to wait.
        """
        self._look(within)
        return self._status is not None or self._lost

    def abandon(self) -> None:
        """Kill the process, which then counts as lost, but do not wait for its end. Any thread may call this."""
        self._channel.hang_up()

    def end_box(self) -> None:
        """Kill every process in the box. The exit status of this process can still be read."""
        if self._box is not None:
            with contextlib.suppress(OSError):
                self._box.end()

    def end(self) -> None:
        """Kill the process and everything that it started in its box. This may be called twice."""
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
    """The result of a command that ran in a box.

    Attributes:
        returncode: As in :class:`subprocess.Popen`: the exit code, or a negative number if a signal ended it. None if
            the command was stopped at its time limit.
        output: Standard output and standard error, in the order of arrival, cut to the allowed number of bytes.
        cut: True if output was dropped, because there was more than the allowed number of bytes.
    """

    returncode: int | None
    output: bytes
    cut: bool


class _Command:
    """A command in a box. At the end of the ``with`` block, it and everything that it started are ended.

    Args:
        owner: What ends the command.
        output: A descriptor from which the output of the command is read.
        pid: The PID, as seen from the host, of the box's first process.
    """

    def __init__(self, owner: Box | ForkedProcess, output: int, pid: int) -> None:
        self._owner, self._output, self.pid = owner, output, pid

    def end(self) -> None:
        """Kill the command and everything that it started. This may be called twice."""
        if self._output >= 0:
            self._owner.end()
            os.close(self._output)
            self._output = -1

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.end()


class Running(_Command):
    """A command that bubblewrap has started in a box of its own."""

    def __init__(self, box: Box, output: int) -> None:
        super().__init__(box, output, box.pid)
        self._box = box

    def read(self, within: float) -> bytes | None:
        """Return the output since the last call; None if there is none yet, b"" at the end.

        Args:
            within: The maximum number of seconds to wait for output.
        """
        if not select.select([self._output], [], [], within)[0]:
            return None
        return os.read(self._output, 1 << 16)

    def exit_code(self) -> int | None:
        """After the end of the output, wait until the box ends. Return the exit code as in ``Finished.returncode``."""
        return _returncode(self._box.wait_end())

    def interrupt(self) -> None:
        """Send Ctrl-C as a terminal does: to the whole process group at once.

        If the processes got the signal one by one, a program could end first, and `ros2 run` would end with it and
        never get the Ctrl-C that it gets in a terminal. The signal does not end the box, although the box's first
        process is in the group, too: a PID namespace's first process ignores signals for which it has no handler
        (pid_namespaces(7)).
        """
        signal_group(self.pid, signal.SIGINT)


_CLOSING_SECONDS = 10.0
"""Seconds for which a command may still run after it closed its output."""


class WarmCommand(_Command):
    """A command that a fork server has forked into a separate box. The box ends with the command's process."""

    def __init__(self, process: ForkedProcess, output: int, pid: int) -> None:
        super().__init__(process, output, pid)
        self._process = process

    def read(self, within: float) -> bytes | None:
        """Return new output; see :meth:`Running.read`. Once the command has ended, kill what it left running."""
        process = self._process.fileno()
        ready = select.select([self._output, process], [], [], within)[0]
        if process in ready:
            self._process.end_box()  # processes left behind may hold the output open, or write forever
        return os.read(self._output, 1 << 16) if ready else None

    def exit_code(self) -> int | None:
        """Wait for the command's end, and return its exit code in the form of ``Finished.returncode``.

        Call this only after the end of the output. The result is None if the exit code is unknown.
        """
        if not self._process.wait(_CLOSING_SECONDS):
            self._process.end_box()  # the command closed its output but goes on; this is the last chance to stop it
            self._process.wait(ANSWER_SECONDS)
        status = self._process.status
        if status is None:
            return None
        code = os.waitstatus_to_exitcode(status)
        return _returncode(code) if code >= 0 else code

    def interrupt(self) -> None:
        """Send Ctrl-C as a terminal does: to the whole process group."""
        self._process.interrupt()


def _returncode(status: int) -> int:
    """Convert a shell's exit code, 128 plus the number of a signal, to that of :class:`subprocess.Popen`."""
    return status if status < 128 else 128 - status
