"""A command that runs in a box, seen from who has started it."""

from __future__ import annotations

import os
import select
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, Self

if TYPE_CHECKING:
    from autograder.boxes.sandbox import Enclosure

ANSWER_SECONDS = 30.0
"""Seconds of wall time in which the supervisor of the boxes answers."""


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
        status = self._enclosure.wait_end(self._name, ANSWER_SECONDS)
        return self._finished(status if status < 128 else 128 - status)

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
