"""A program in a session of its own: read as long as it is wanted, and ended with all that it has started."""

from __future__ import annotations

import contextlib
import os
import select
import signal
import subprocess
import time
from typing import IO, TYPE_CHECKING, Self

from autograder.process_trees import descendants, kill, known, signal_group

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from pathlib import Path
LOOK_EVERY = 0.5
"""Seconds between two questions whether a program is still wanted."""


class OwnSession:
    """A process that no interrupt of a terminal or a kernel reaches, with stdout and stderr in one.

    Args:
        command: The program and its arguments.
        environment: Its whole environment.
        cwd: Where it runs; where this process does, if None.
    """

    def __init__(
        self, command: Sequence[str], environment: Mapping[str, str], cwd: Path | None = None
    ) -> None:
        self._process = subprocess.Popen(
            list(command),
            cwd=cwd,
            env=dict(environment),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            start_new_session=True,
        )
        self.pid = self._process.pid

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.end()
        self.output.close()

    @property
    def output(self) -> IO[bytes]:
        """Its output, for callers that do not use :meth:`read`."""
        assert self._process.stdout is not None
        return self._process.stdout

    def read(self, within: float) -> bytes | None:
        """Its output since the last call; None for nothing yet, no bytes at its end.

        Args:
            within: Seconds to wait for something.
        """
        data = self._read(within)
        if data == b"":
            self._process.wait()
        return data

    def _read(self, within: float) -> bytes | None:
        if self.output.closed:
            return b""
        ready, _, _ = select.select([self.output], [], [], within)
        return os.read(self.output.fileno(), 1 << 16) if ready else None

    def collect(
        self, limit: float, size: int, unwanted: Callable[[], bool] = lambda: False
    ) -> tuple[bytes, bool]:
        """Its output to its end, or until nobody wants it any more.

        Args:
            limit: Seconds of wall time in which it must have ended.
            size: Bytes that are kept.
            unwanted: Asked now and then.

        Returns:
            The output, and whether the time was over. Where it has not ended, :meth:`exit_code` is None.
        """
        output = bytearray()
        deadline = time.monotonic() + limit
        while (data := self._read(LOOK_EVERY)) != b"":
            output += (data or b"")[: size - len(output)]
            if (late := time.monotonic() > deadline) or unwanted():
                return bytes(output), late
        try:
            self._process.wait(max(0.0, deadline - time.monotonic()))
        except subprocess.TimeoutExpired:
            return bytes(output), True
        return bytes(output), False

    def exit_code(self) -> int | None:
        """Its exit code once it has ended; negative for a signal."""
        return self._process.poll()

    def wait(self) -> int:
        """Its exit code, once it has ended."""
        return self._process.wait()

    def interrupt(self) -> None:
        """Ctrl-C, as a terminal sends it: to the process and to all of its group."""
        if self.exit_code() is None:
            signal_group(self.pid, signal.SIGINT)

    def end(self, polite: float = 0.0) -> None:
        """Kill it and all that it has started; may be called twice.

        What was below the process when this began is ended wherever it has gone to since.

        Args:
            polite: Seconds of wall time that it has after an interrupt, to end by itself.
        """
        family = self._below()
        if polite > 0.0 and self.exit_code() is None:
            self.interrupt()
            with contextlib.suppress(subprocess.TimeoutExpired):
                self._process.wait(timeout=polite)
            family |= self._below()
        kill(family)
        signal_group(self.pid, signal.SIGKILL)
        self._process.wait()

    def _below(self) -> set[tuple[int, str]]:
        """The processes that it has started and these have started, with the time at which each began."""
        return known(descendants(self.pid)) if self.exit_code() is None else set()
