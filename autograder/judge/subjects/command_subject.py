"""Any command as a subject: a script, a colcon executable, a C++ node, a launch."""

from __future__ import annotations

import os
import signal
import subprocess
import threading
from typing import IO, TYPE_CHECKING, Any, Protocol, cast

from autograder.judge.settings import subject_environment
from autograder.judge.subjects.subject import CannotStart, InOwnProcesses
from autograder.process_trees import (
    adopt_orphans,
    descendants,
    die_with_parent,
    end_descendants,
    end_each,
    signal_group,
)
from autograder.standard_output import short_lines

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from io import BufferedReader
    from pathlib import Path

    from autograder.judge.bench.recorder import Recorder

    Record = Callable[..., None]

MAX_LINE = 4_000
"""Characters of one line that are kept."""
MAX_OUTPUT = 2_000_000
"""Bytes of output that are kept of one run."""
READ_LIMIT = 2.0
"""Seconds in which the last output of a command that has exited must have been read."""
POLITE = 1.0
"""Seconds that a command has to end after SIGINT, before it is killed."""


LEFTOVERS = 1.0
"""Seconds in which what a command has left behind must have ended."""


class Box(Protocol):
    """A place where commands are shut off from the user's files and network; this process is on the same network."""

    def enter(self) -> None:
        """Go there; called once, before anything of ROS is loaded.

        Raises:
            OSError: That is not possible here.
        """

    def start_of(self, command: Sequence[str], environment: Mapping[str, str]) -> tuple[list[str], list[int]]:
        """The command to start in place of another, and the descriptors to hand down, which the caller closes."""

    def limit(self) -> None:
        """Take the limits of a box; called in the child."""


class CommandSubject(InOwnProcesses):
    """Runs a command in a session of its own, reads all it prints and ends it with everything it started."""

    def __init__(self, command: Sequence[str], cwd: Path | None = None, box: Box | None = None) -> None:
        self._command = list(command)
        self._box = box
        self._cwd = cwd
        self._domain_id = 0
        self._process: subprocess.Popen[bytes] | None = None
        self._done = threading.Event()
        self._dying = threading.Event()
        self._last_words: list[str] = []
        # Whatever a subject leaves behind becomes this process's child and can be found and killed.
        adopt_orphans()

    def begin(self, domain_id: int) -> None:
        """Remember the domain that the command's environment will name."""
        self._domain_id = domain_id

    def start(self, recorder: Recorder, arguments: tuple[Any, ...], options: dict[str, Any]) -> None:
        """Start the command with the arguments appended.

        Raises:
            CannotStart: It does not exist or may not be executed.
        """
        del options  # only a notebook's function takes keyword arguments
        command = [*self._command, *map(str, arguments)]
        try:
            self._process = self._spawn(
                command, subject_environment(self._domain_id, boxed=self._box is not None)
            )
        except (OSError, ValueError) as error:
            raise CannotStart(f"cannot start {self._command[0]!r}: {error}") from error
        self._done, self._dying, self._last_words = threading.Event(), threading.Event(), []
        follow = (recorder.in_this_part(), recorder.end_of_this_part(), self._process, self._done)
        threading.Thread(target=self._follow, args=follow, daemon=True).start()

    def _spawn(self, command: Sequence[str], environment: Mapping[str, str]) -> subprocess.Popen[bytes]:
        descriptors: list[int] = []
        if self._box is not None:
            command, descriptors = self._box.start_of(command, environment)
        try:
            return subprocess.Popen(
                command,
                cwd=self._cwd,
                env=environment,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                start_new_session=True,
                preexec_fn=self._in_the_child,
                pass_fds=descriptors,
            )
        finally:
            for descriptor in descriptors:
                os.close(descriptor)

    def _in_the_child(self) -> None:
        if self._box is not None:
            self._box.limit()
        # A judge that runs in the background of a shell ignores Ctrl-C; its subjects must not.
        signal.signal(signal.SIGINT, signal.SIG_DFL)
        die_with_parent()

    def release(self) -> None:
        """A command runs from its start."""

    def interrupt(self) -> None:
        """SIGINT to its process group, as a terminal sends it."""
        if self._process is not None and self._process.poll() is None:
            signal_group(self._process.pid, signal.SIGINT)

    @property
    def ended(self) -> bool:
        """True if the command has exited and all it printed was read."""
        return self._done.is_set()

    def processes(self) -> frozenset[int]:
        """The ids of the processes that the command has started and that live."""
        return frozenset(descendants(self._process.pid)) if self._process else frozenset()

    def stack(self) -> str:
        """Abort the command: Python's faulthandler, which its environment has switched on, prints the stacks.

        What hangs may be a child of the command: ``ros2 run`` starts the student's program and waits for it. Children
        come first and each alone, so that no two write into each other's lines.
        """
        process = self._process
        if process is None or self.ended:
            return ""
        self._dying.set()
        end_each((*reversed(descendants(process.pid)), process.pid), signal.SIGABRT, READ_LIMIT)
        self._done.wait(READ_LIMIT)
        return "\n".join(self._last_words)

    def stop(self) -> None:
        """SIGINT to its process group, then SIGKILL to whatever is left of it."""
        if self._process is None:
            return
        self._dying.set()
        if self._process.poll() is None:
            signal_group(self._process.pid, signal.SIGINT)
            self._done.wait(POLITE)
        signal_group(self._process.pid, signal.SIGKILL)
        end_descendants(LEFTOVERS)
        self._process.wait()
        self._process = None

    def _follow(
        self, record: Record, end: Record, process: subprocess.Popen[bytes], done: threading.Event
    ) -> None:
        budget = _Budget(MAX_OUTPUT)
        readers = [
            threading.Thread(target=self._read, args=(record, stream, name, budget), daemon=True)
            for name, stream in (("stdout", process.stdout), ("stderr", process.stderr))
        ]
        for reader in readers:
            reader.start()
        code = process.wait()
        for reader in readers:
            # All that it printed must be read before its end is known. A grandchild may hold the pipe open,
            # though.
            reader.join(timeout=READ_LIMIT)
        if self._dying.is_set():
            record("subject", "aborted", code=code)  # what the judge has ended did not end by itself
            done.set()
        else:
            end("exited", done.set, code=code)

    def _read(self, record: Record, stream: IO[bytes] | None, name: str, budget: _Budget) -> None:
        assert stream is not None
        with stream:
            for line in short_lines(cast("BufferedReader", stream), MAX_LINE):
                if budget.left <= 0:
                    continue
                budget.left -= len(line)
                text = line.decode("utf-8", "replace").rstrip("\r\n")
                if self._dying.is_set() and name == "stderr":
                    self._last_words.append(text)
                else:
                    record("output", name, text=text)


class _Budget:
    def __init__(self, size: int) -> None:
        self.left = size
