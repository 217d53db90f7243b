"""Starts a program in a session of its own (setsid(2)), so that all its processes can be found and ended."""

from __future__ import annotations

import contextlib
import os
import select
import shutil
import signal
import subprocess
from typing import TYPE_CHECKING, Self

from autograder import process_trees
from course_runtime.python_child import python_child

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path


class OwnSession:
    """A program in a new session, so that Ctrl-C in the terminal or an interrupt of the kernel does not reach it.

    The stdout and stderr of the program are one stream. A keeper process (:func:`autograder.process_trees.keep`) is the
    parent of the program, and ends all processes of the program as soon as this process ends, for whatever reason.

    Args:
        command: The program and its arguments.
        environment: All environment variables.
        cwd: The working folder; None for the working folder of this process.
        holds: Descriptors, such as that of a lock, that stay open until no process of the program is alive.

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
        """Return the output since the last call; None if nothing has come yet, b"" at the end.

        Args:
            within: The maximum number of seconds to wait for output.
        """
        if self._output.closed:
            return b""
        ready, _, _ = select.select([self._output], [], [], within)
        data = os.read(self._output.fileno(), 1 << 16) if ready else None
        if data == b"":
            self._process.wait()
        return data

    def exit_code(self) -> int | None:
        """Return the exit code once the program has ended; negative if a signal ended it."""
        return self._process.poll()

    def wait(self) -> int:
        """Wait for the program to end. Return its exit code."""
        return self._process.wait()

    def interrupt(self) -> None:
        """Send Ctrl-C as a terminal does: to the program and its whole process group."""
        if self.exit_code() is None:
            process_trees.signal_group(self.pid, signal.SIGINT)

    def end(self, polite: float = 0.0) -> None:
        """Kill the program and everything that it has started, even outside its group. This may be called twice.

        Args:
            polite: If not 0, interrupt the program first, and give it this many seconds of wall time to end by
                itself.
        """
        if polite > 0.0:
            self.interrupt()
            with contextlib.suppress(subprocess.TimeoutExpired):
                self._process.wait(timeout=polite)
        if self.exit_code() is None:
            process_trees.end_below(self.pid)
        # Kill the keeper, which may be suspended. The signal goes to the whole group, because the program may have
        # killed the keeper but left other processes.
        process_trees.signal_group(self.pid, signal.SIGKILL)
        self._process.wait()
