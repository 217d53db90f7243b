"""Starts a program that a check runs, ends all its processes, and watches the processes that a launch starts.

The program runs in a new session (setsid(2)), so that all its processes can be found and ended. The command lines of
the processes of a launch are reported to the check.
"""

from __future__ import annotations

import contextlib
import os
import select
import shutil
import signal
import subprocess
import threading
from pathlib import Path
from typing import TYPE_CHECKING, Self

from autograder import process_trees
from autograder.kit.output.launched_processes import Process, process_line
from course_runtime.python_child import python_child

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence


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


LOOK_EVERY = 0.05
"""Seconds between two scans of the launch's processes."""
MAX_COMMAND_LINE = 32_000
"""The maximum number of bytes read of a command line. It is needed because a process can make its own command line
megabytes long, and change it before each scan.
"""
MAX_COMMAND_LINES = 500
"""The maximum number of command lines to report for one launch; a usual launch has about ten."""


@contextlib.contextmanager
def watched(pid: int, report: Callable[[str], None]) -> Iterator[None]:
    """Watch all descendants of a process, in a thread, until the ``with`` block ends.

    Args:
        pid: The id of the process whose descendants are watched.
        report: Called once for each process and command line, with the line for the check's report.
    """
    ended = threading.Event()
    watcher = threading.Thread(target=_watch, args=(pid, ended, report), daemon=True)
    watcher.start()
    try:
        yield
    finally:
        ended.set()
        watcher.join()


def _watch(pid: int, ended: threading.Event, report: Callable[[str], None]) -> None:
    """Report each descendant of a process once for each of its command lines, until ``ended`` is set."""
    known: set[tuple[int, tuple[str, ...]]] = set()
    while not ended.wait(LOOK_EVERY):
        for child in process_trees.descendants(pid):
            argv = tuple(_arguments_of(child))
            if argv and (child, argv) not in known and len(known) < MAX_COMMAND_LINES:
                known.add((child, argv))
                parent = int((_status(child, "PPid") or ["0"])[0])
                report(process_line(Process(_own_id(child), _own_id(parent), argv)))


def _arguments_of(pid: int) -> list[str]:
    """Return the arguments with which a process was started; empty if it has ended."""
    try:
        with Path(f"/proc/{pid}/cmdline").open("rb", buffering=0) as file:
            words = file.read(MAX_COMMAND_LINE).rstrip(b"\0")
    except OSError:
        return []
    return [word.decode("utf-8", "replace") for word in words.split(b"\0")] if words else []


def _own_id(pid: int) -> int:
    """Return a process's id in its own PID namespace; 0 if the process has ended."""
    return int((_status(pid, "NSpid") or ["0"])[-1])


def _status(pid: int, name: str) -> list[str]:
    """Return the words in a line of ``/proc/PID/status`` (proc(5)); empty if the line does not exist."""
    try:
        lines = Path(f"/proc/{pid}/status").read_text().splitlines()
    except OSError:
        return []
    return next((line.split()[1:] for line in lines if line.startswith(f"{name}:")), [])


def print_line(line: str) -> None:
    """Print a line in one write, so that other output to the same pipe cannot come in between."""
    os.write(1, f"{line}\n".encode("utf-8", "replace"))
