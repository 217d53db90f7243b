"""A program in a session of its own: read while it is wanted, and ended with everything that it has started."""

from __future__ import annotations

import contextlib
import os
import select
import shutil
import signal
import subprocess
import time
from typing import TYPE_CHECKING, Self

from autograder import process_trees
from environment.python_child import python_child

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from pathlib import Path
LOOK_EVERY = 0.5
"""Seconds between checks whether a program is still wanted."""


class OwnSession:
    """A program that a terminal's or kernel's interrupt does not reach, with stdout and stderr in one stream.

    It runs below a keeper process (:func:`autograder.process_trees.keep`), so that none of its processes outlives
    this one, however this one ends.

    Args:
        command: The program and its arguments.
        environment: All environment variables.
        cwd: The working folder; None for this process's.
        holds: Descriptors that stay open until no process of the program is alive, such as a lock's.

    Raises:
        FileNotFoundError: The program does not exist.
    """

    def __init__(
        self,
        command: Sequence[str],
        environment: Mapping[str, str],
        cwd: Path | None = None,
        holds: Sequence[int] = (),
    ) -> None:
        if shutil.which(command[0], path=environment.get("PATH", os.defpath)) is None:
            raise FileNotFoundError(command[0])
        keeper = python_child("-I", "-S", process_trees.__file__, str(os.getpid())).command
        self._process = subprocess.Popen(
            [*keeper, *command],
            cwd=cwd,
            env=dict(environment),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            start_new_session=True,
            pass_fds=holds,
        )
        assert self._process.stdout is not None
        self._output = self._process.stdout
        self.pid = self._process.pid

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.end()
        self._output.close()

    def read(self, within: float) -> bytes | None:
        """Return the output since the last call; None for nothing yet, b"" at its end.

        Args:
            within: Seconds to wait for output.
        """
        if self._output.closed:
            return b""
        ready, _, _ = select.select([self._output], [], [], within)
        data = os.read(self._output.fileno(), 1 << 16) if ready else None
        if data == b"":
            self._process.wait()
        return data

    def collect(
        self, limit: float, size: int, unwanted: Callable[[], bool] = lambda: False
    ) -> tuple[bytes, bool]:
        """Read the output until its end, or until it is no longer wanted.

        Args:
            limit: Seconds of wall time within which the program must end.
            size: The bytes to keep.
            unwanted: Called from time to time; True stops.

        Returns:
            The output, and whether the time was up. If the program has not ended, :meth:`exit_code` is None.
        """
        output = bytearray()
        deadline = time.monotonic() + limit
        while (data := self.read(LOOK_EVERY)) != b"":
            output += (data or b"")[: size - len(output)]
            if (late := time.monotonic() > deadline) or unwanted():
                return bytes(output), late
        return bytes(output), False

    def exit_code(self) -> int | None:
        """The exit code once the program has ended; negative for a signal."""
        return self._process.poll()

    def wait(self) -> int:
        """Wait for the program to end. Return its exit code."""
        return self._process.wait()

    def interrupt(self) -> None:
        """Send Ctrl-C as a terminal does: to the program and to its whole group."""
        if self.exit_code() is None:
            process_trees.signal_group(self.pid, signal.SIGINT)

    def end(self, polite: float = 0.0) -> None:
        """Kill the program and everything that it has started, even outside its group; may be called twice.

        Args:
            polite: Seconds of wall time, after an interrupt, in which it may end by itself.
        """
        if polite > 0.0:
            self.interrupt()
            with contextlib.suppress(subprocess.TimeoutExpired):
                self._process.wait(timeout=polite)
        if self.exit_code() is None:
            process_trees.end_below(self.pid)
        # The keeper, which may be stopped; and, if the program has killed the keeper, what is left.
        process_trees.signal_group(self.pid, signal.SIGKILL)
        self._process.wait()
