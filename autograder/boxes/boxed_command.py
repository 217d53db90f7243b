"""A command that runs in a box, seen from who has started it."""

from __future__ import annotations

import contextlib
import os
import select
import signal
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, Self

from autograder.process_trees import descendants

if TYPE_CHECKING:
    from autograder.boxes.forked import PlacedProcess
    from autograder.boxes.sandbox import Enclosure

ANSWER_SECONDS = 30.0
"""Seconds of wall time in which the supervisor of the boxes answers."""
_CLOSING_SECONDS = 10.0
"""Seconds from the end of a command's output to its own."""
_ITS_TIME = 1e6
"""Seconds, more than any check lasts: a program runs as long as the judge wants it to."""


@dataclass(frozen=True)
class Finished:
    """The end of a command in a box.

    Attributes:
        returncode: As :class:`subprocess.Popen` has it: the exit code; negative for a signal. None where it was
            ended at its limit.
        output: What it said on standard output and standard error, in that order of arrival, at most the allowed
            number of bytes.
        cut: Whether it said more.
        seconds: Wall time.
    """

    returncode: int | None
    output: bytes
    cut: bool
    seconds: float


class Running:
    """A command that runs in a box; leaving the context ends it and all that it has started."""

    def __init__(self, enclosure: Enclosure, name: str, pid: int, output: int, most: int) -> None:
        self._enclosure, self._name, self._output, self._most = enclosure, name, output, most
        self._began = time.monotonic()
        self._kept = bytearray()
        self._cut = False
        self.pid = pid
        """The first process of the box, as the host counts."""

    def fileno(self) -> int:
        """Readable when it has said something, or when it and all that hold its output have ended."""
        return self._output

    def read(self, within: float) -> bool:
        """Take up what it says; False once it has ended.

        Args:
            within: Seconds to wait for something to read.
        """
        if not select.select([self._output], [], [], max(0.0, within))[0]:
            return True
        piece = os.read(self._output, 1 << 16)
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
            self._enclosure.end(self._name)
            return self._finished(None)
        return self._finished(_returncode(self._enclosure.wait_end(self._name, ANSWER_SECONDS)))

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
        """Ctrl-C at everything below the first process of the box, which only waits for the others."""
        for pid in descendants(self.pid):
            with contextlib.suppress(ProcessLookupError, PermissionError):
                os.kill(pid, signal.SIGINT)

    def end(self) -> None:
        """Kill it and all that it has started; may be called twice."""
        if self._output >= 0:
            self._enclosure.end(self._name)
            os.close(self._output)
            self._output = -1

    def _finished(self, returncode: int | None) -> Finished:
        return Finished(returncode, self.said, self._cut, time.monotonic() - self._began)

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

    def __init__(self, process: PlacedProcess, output: int, pid: int) -> None:
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
