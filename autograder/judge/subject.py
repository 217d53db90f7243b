"""The part of a subject that the judge sees (a subject is the code that it observes), and a command as a subject.

A command may be any program, such as a script, ``ros2 run`` or ``ros2 launch``.
"""

from __future__ import annotations

import os
import signal
import subprocess
import threading
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any, Protocol, cast

import msgspec

from autograder.judge.ros_setup import subject_environment
from autograder.messages.judge_messages import OwnLine, OwnLines
from autograder.process_trees import (
    adopt_orphans,
    descendants,
    die_with_parent,
    end_descendants,
    end_each,
    signal_group,
)
from autograder.standard_output import short_lines
from course_runtime.python_child import python_child

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from io import BufferedReader

    from autograder.judge.bench.discovery import Endpoint
    from autograder.judge.bench.recorder import Recorder
    from autograder.verdict import Verdict

    Record = Callable[..., None]


class Subject(Protocol):
    """A class or function in a notebook, a command, a workspace, or a launch file, which the judge observes.

    Implementations write into the recorder: an ``output`` event for each line of output, and ``subject`` events named
    ``constructed``, ``returned``, ``raised`` or ``exited``.
    """

    shares_participant: bool
    """True if all runs share one ROS participant."""
    in_a_notebook: bool
    """True if a check cell, and perhaps a student, waits for the verdict."""
    busy: float
    """Processor time in seconds that a thread in the student's code used while :meth:`stack` watched it."""
    keeper: str
    """The name of the node that keeps the participant alive and has no endpoints of its own; empty if there is none."""

    def begin(self, domain_id: int) -> None:
        """Prepare for the first run, on the ROS domain of this check. The judge calls this once."""

    def tell_so_far(self, verdict: Verdict, words: str) -> None:
        """Show the waiting student what the judge knows so far: see :class:`autograder.messages.judge_messages.SoFar`.

        Only a notebook shows it.
        """

    @property
    def is_building(self) -> bool:
        """True until the packages of a workspace are built for the first time; False if nothing has to be built."""

    def renew(self) -> None:
        """Use a new participant for the next run. An old one discovers the judge's new participant only slowly."""

    def knows(self, *, there: set[Endpoint], gone: set[Endpoint]) -> bool:
        """Wait until the next run's participant has discovered the judge's new endpoints, and lost the removed ones.

        Without this wait, a subject could still see a service of an earlier run and call it.

        Args:
            there: The new endpoints.
            gone: The removed endpoints.

        Returns:
            False if this did not happen within a generous time limit, or if the notebook does not answer.
        """

    def start(self, recorder: Recorder, arguments: tuple[Any, ...], options: dict[str, Any]) -> None:
        """Start a run."""

    def release(self) -> None:
        """Spin the node of this run. Before this call, only the node's constructor has run."""

    def interrupt(self) -> None:
        """Send Ctrl-C, as a terminal does. If the run ends after that, it counts as ended by itself."""

    @property
    def ended(self) -> bool:
        """True if this run has ended by itself."""

    @property
    def marker(self) -> str | None:
        """The name of a topic that is on the graph only after all of the subject's endpoints; None if there is none."""

    @property
    def may_make_more(self) -> bool:
        """True if the node is not spun yet, and its timer or thread may make more endpoints after :meth:`release`."""

    @property
    def is_held(self) -> bool:
        """True for a class of a notebook until :meth:`release`: nothing spins it yet."""

    def processes(self) -> frozenset[int]:
        """Return the ids of the running processes that the subject has started; none if they are not known."""

    def stack(self) -> str:
        """Return the stack of each thread, innermost call first, as faulthandler prints it; empty if unknown.

        A command is aborted, so that it prints its stacks. The run then does not count as ended by itself.
        """

    def stop(self) -> None:
        """End the run by any means. Afterwards no process, thread or node of the run is left."""

    def own_lines(self) -> list[OwnLine]:
        """Return the lines of the student's code that a card may quote, as the subject's side claims."""


class InOwnProcesses:
    """Base class of subjects whose runs are separate processes, each with its own DDS participant."""

    shares_participant = False
    in_a_notebook = False
    is_building = False
    busy = 0.0
    keeper = ""
    marker = None
    may_make_more = False
    is_held = False

    def processes(self) -> frozenset[int]:
        """Return an empty set: the subject's processes are not children of the judge, so their ids are unknown."""
        return frozenset()

    def tell_so_far(self, verdict: Verdict, words: str) -> None:
        """Do nothing, because a command shows no card while it is checked."""

    def renew(self) -> None:
        """Do nothing, because each run is a new process, which has a new participant anyway."""

    def knows(self, *, there: set[Endpoint], gone: set[Endpoint]) -> bool:
        """Return True: a new participant has discovered nothing yet, so it cannot see removed endpoints."""
        del there, gone
        return True

    def own_lines(self) -> list[OwnLine]:
        """Return no lines: the sources are not read by a process that a grader trusts."""
        return []


class CannotStart(RuntimeError):
    """The command does not exist or is not executable."""


MAX_LINE = 4_000
"""The maximum length of a line of output, in characters."""
MAX_OUTPUT = 2_000_000
"""The maximum size of the output of one run, in bytes."""
READ_LIMIT = 2.0
"""Time limit in seconds for reading the rest of the output after a command has exited."""
SIGINT_LIMIT = 1.0
"""Seconds to wait between SIGINT and SIGKILL."""


LEFTOVERS = 1.0
"""Time limit in seconds. A process that a command left behind has to end within this time."""


class CommandBox(Protocol):
    """A sandbox with its own network, which keeps commands from the user's files and network."""

    def enter(self) -> None:
        """Move this process, the judge, into the sandbox's network. Call this once, before ROS is imported.

        Raises:
            OSError: This machine does not allow a process to enter the sandbox's network.
        """

    def start_of(self, command: Sequence[str], environment: Mapping[str, str]) -> tuple[list[str], list[int]]:
        """Return the command line that runs a command in the sandbox, and descriptors to pass to it and then close."""

    def limit(self) -> None:
        """Apply the limits of the sandbox to this process, a child that is about to run the command."""


class CommandSubject(InOwnProcesses):
    """A command that runs in a new session. Its output is recorded, and at the end all its processes are ended."""

    def __init__(
        self, command: Sequence[str], cwd: Path | None = None, box: CommandBox | None = None
    ) -> None:
        self._command = list(command)
        self._box = box
        self._cwd = cwd
        self._domain_id = 0
        self._process: subprocess.Popen[bytes] | None = None
        self._done = threading.Event()
        self._dying = threading.Event()
        self._last_words: list[str] = []
        # Processes that a subject leaves behind become children of the judge, so that the judge can find and kill them.
        adopt_orphans()

    def begin(self, domain_id: int) -> None:
        """Set the ROS domain for the command's environment variables."""
        self._domain_id = domain_id

    def start(self, recorder: Recorder, arguments: tuple[Any, ...], options: dict[str, Any]) -> None:
        """Start the command with the arguments appended.

        Raises:
            CannotStart: The command does not exist or is not executable.
        """
        del options  # only a notebook's function takes keyword arguments
        command = [*self._command, *map(str, arguments)]
        try:
            self._process = self._spawn(command)
        except (OSError, ValueError) as error:
            raise CannotStart(f"cannot start {self._command[0]!r}: {error}") from error
        self._done, self._dying, self._last_words = threading.Event(), threading.Event(), []
        follow = (recorder.record, recorder.end, self._process, self._done)
        threading.Thread(target=self._follow, args=follow, daemon=True).start()

    def _spawn(self, command: Sequence[str]) -> subprocess.Popen[bytes]:
        environment = subject_environment(self._domain_id, boxed=self._box is not None)
        descriptors: list[int] = []
        if self._box is not None:
            command, descriptors = self._box.start_of(command, environment)
            environment = {}  # the command line has them; a box sees the environment of its first process
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
        # If the judge was started in the background of a shell, it ignores SIGINT, but its subjects must not inherit
        # this.
        signal.signal(signal.SIGINT, signal.SIG_DFL)
        die_with_parent()

    def release(self) -> None:
        """Do nothing, because a command runs from its start on."""

    def interrupt(self) -> None:
        """Send SIGINT to the command's process group, as Ctrl-C in a terminal does."""
        if self._process is not None and self._process.poll() is None:
            signal_group(self._process.pid, signal.SIGINT)

    @property
    def ended(self) -> bool:
        """True if the command has exited and all its output has been read."""
        return self._done.is_set()

    def processes(self) -> frozenset[int]:
        """Return the ids of the running processes that the command has started."""
        return frozenset(descendants(self._process.pid)) if self._process else frozenset()

    def stack(self) -> str:
        """Abort the command, and return the stacks that Python's faulthandler prints.

        Children of the command are aborted first, because the process that hangs may be one of them. For example,
        ``ros2 run`` starts the student's program and waits for it. Only one child at a time is aborted, so that the
        stacks do not mix.
        """
        process = self._process
        if process is None or self.ended:
            return ""
        self._dying.set()
        end_each((*reversed(descendants(process.pid)), process.pid), signal.SIGABRT, READ_LIMIT)
        self._done.wait(READ_LIMIT)
        return "\n".join(self._last_words)

    def stop(self) -> None:
        """Send SIGINT to the command's process group, then SIGKILL to the processes that are left."""
        if self._process is None:
            return
        self._dying.set()
        if self._process.poll() is None:
            signal_group(self._process.pid, signal.SIGINT)
            self._done.wait(SIGINT_LIMIT)
        signal_group(self._process.pid, signal.SIGKILL)
        end_descendants(LEFTOVERS)
        self._process.wait()
        self._process = None

    def own_lines(self) -> list[OwnLine]:
        """Return the lines of the Python files and workspaces in the command, as another process reads them."""
        paths = [
            part for part in self._command if part.endswith(".py") or Path(self._cwd or ".", part).is_dir()
        ]
        reader = [*python_child("-m", "autograder.own_lines").command, *paths]
        process = self._spawn(reader)
        try:
            output, _ = process.communicate(timeout=READ_LIMIT)
            return msgspec.json.decode(output[:MAX_OUTPUT], type=OwnLines).lines
        except (subprocess.TimeoutExpired, msgspec.DecodeError):
            return []
        finally:
            signal_group(process.pid, signal.SIGKILL)

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
            # Read all output before recording the end. But wait only up to a limit, because a grandchild may hold the
            # pipe open.
            reader.join(timeout=READ_LIMIT)
        if self._dying.is_set():
            record("subject", "aborted", code=code)  # the command did not end by itself: the judge aborted it
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
