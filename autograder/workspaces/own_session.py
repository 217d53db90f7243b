"""A program in a session of its own: read as long as it is wanted, and ended with all that it has started."""

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
"""Seconds between two questions whether a program is still wanted."""


class OwnSession:
    """A program that no interrupt of a terminal or a kernel reaches, with stdout and stderr in one.

    It runs below a keeper (:func:`autograder.process_trees.keep`), so that nothing of it outlives this process, however
    that ends.

    Args:
        command: The program and its arguments.
        environment: Its whole environment.
        cwd: Where it runs; where this process does, if None.
        holds: Descriptors that stay open until nothing of the program lives any more, such as a lock's.

    Raises:
        FileNotFoundError: There is no such program.
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
        """Its output since the last call; None for nothing yet, no bytes at its end.

        Args:
            within: Seconds to wait for something.
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
        while (data := self.read(LOOK_EVERY)) != b"":
            output += (data or b"")[: size - len(output)]
            if (late := time.monotonic() > deadline) or unwanted():
                return bytes(output), late
        return bytes(output), False

    def exit_code(self) -> int | None:
        """Its exit code once it has ended; negative for a signal."""
        return self._process.poll()

    def wait(self) -> int:
        """Its exit code, once it has ended."""
        return self._process.wait()

    def interrupt(self) -> None:
        """Ctrl-C, as a terminal sends it: to the program and to all of its group."""
        if self.exit_code() is None:
            process_trees.signal_group(self.pid, signal.SIGINT)

    def end(self, polite: float = 0.0) -> None:
        """Kill it and all that it has started, wherever that has gone to since; may be called twice.

        Args:
            polite: Seconds of wall time that it has after an interrupt, to end by itself.
        """
        if polite > 0.0:
            self.interrupt()
            with contextlib.suppress(subprocess.TimeoutExpired):
                self._process.wait(timeout=polite)
        if self.exit_code() is None:
            process_trees.end_below(self.pid)
        # The keeper, who may be stopped; and what it has left where the program has killed it.
        process_trees.signal_group(self.pid, signal.SIGKILL)
        self._process.wait()
