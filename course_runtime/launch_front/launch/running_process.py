"""A process of a launch: it is started, its output is read, and it is ended."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
from dataclasses import dataclass, field
from typing import IO, TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from .screen import OutputPlan
    from .timers import Timer

_CHUNK = 65536  # the maximum number of bytes to read at once


@dataclass(frozen=True)
class Plan:
    """All settings that are decided before a process starts.

    Attributes:
        name: The name of the process, such as `talker-1`.
        cmd: The command line.
        shell: True to run the command in a shell.
        cwd: The folder in which the process starts; None for the folder of the launch.
        env: The environment of the process.
        output: The destinations of its lines.
        output_format: The template of a shown line. It may use `line` and `this` (the action).
        emulate_tty: True to connect the output to a pseudo-terminal, so that Python does not hold back lines.
        sigterm_timeout: Seconds from SIGINT to SIGTERM.
        sigkill_timeout: Seconds from SIGTERM to SIGKILL.
    """

    name: str
    cmd: Sequence[str]
    shell: bool
    cwd: str | None
    env: Mapping[str, str] = field(repr=False)
    output: OutputPlan
    output_format: str
    emulate_tty: bool
    sigterm_timeout: float
    sigkill_timeout: float


class RunningProcess:
    """One run of a process. It leads a process group, so that everything that it starts ends with it."""

    def __init__(self, action: Any, plan: Plan) -> None:
        self.action = action
        self.plan = plan
        self.escalation: list[Timer] = []
        self.streams: dict[str, IO[bytes]] = {}
        self._process: subprocess.Popen[bytes] | None = None
        self._partial = {"stdout": b"", "stderr": b""}

    @property
    def pid(self) -> int:
        """The process id.

        Raises:
            RuntimeError: The process has not been started.
        """
        if self._process is None:
            raise RuntimeError(f"process {self.plan.name} has not been started")
        return self._process.pid

    def start(self) -> None:
        """Start the process.

        Raises:
            OSError: The program cannot be started.
        """
        command: Any = " ".join(self.plan.cmd) if self.plan.shell else list(self.plan.cmd)
        ends = {name: os.openpty() if self.plan.emulate_tty else os.pipe() for name in self._partial}
        reading = {name: pair[0] for name, pair in ends.items()}
        try:
            self._process = subprocess.Popen(
                command,
                shell=self.plan.shell,
                cwd=self.plan.cwd,
                env=dict(self.plan.env),
                # Nothing is ever written to this pipe, but a program that reads its standard input must not see an
                # end.
                stdin=subprocess.PIPE,
                stdout=ends["stdout"][1],
                stderr=ends["stderr"][1],
                process_group=0,
                preexec_fn=_end_with_parent(),
            )
        except OSError:
            for end in reading.values():
                os.close(end)
            raise
        finally:
            for _, writing in ends.values():
                os.close(writing)
        for name, end in reading.items():
            os.set_blocking(end, False)
            self.streams[name] = os.fdopen(end, "rb", buffering=0)

    def send(self, number: signal.Signals) -> None:
        """Send a signal to the process and to the processes it has started, if they still exist."""
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self.pid, number)

    def poll(self) -> int | None:
        """Return the exit code; None while the process runs."""
        return None if self._process is None else self._process.poll()

    def _data(self, source: str) -> bytes | None:
        """Return the available output: None if there is none yet, an empty text at the end of the stream."""
        try:
            return self.streams[source].read(_CHUNK)
        except OSError:
            # At its end, a pseudo-terminal raises EIO instead of returning an empty text.
            return b""

    def _lines(self, source: str, data: bytes) -> list[bytes]:
        *lines, self._partial[source] = (self._partial[source] + data).split(b"\n")
        return [line.removesuffix(b"\r") for line in lines] if self.plan.emulate_tty else lines

    def read(self, source: str) -> tuple[list[bytes], bool]:
        """Read the available output of a stream once.

        Returns:
            The complete lines, without their ends; and False at the end of the stream.
        """
        data = self._data(source)
        return self._lines(source, data or b""), data != b""

    def drain(self, source: str) -> list[bytes]:
        """Read all available output and return the complete lines."""
        lines: list[bytes] = []
        while data := self._data(source):
            lines += self._lines(source, data)
        return lines

    def rest(self, source: str) -> list[bytes]:
        """Return the last line if it has no line end."""
        rest, self._partial[source] = self._partial[source], b""
        return [rest] if rest else []

    def close(self) -> None:
        """Close the streams, and cancel the signals that were planned in case the process did not end."""
        for stream in self.streams.values():
            stream.close()
        self.streams.clear()
        for timer in self.escalation:
            timer.cancel()
        if self._process is not None and self._process.stdin is not None:
            self._process.stdin.close()


def _end_with_parent() -> Callable[[], None] | None:
    """Return a function that a new process calls, so that the kernel ends the process if the launch is killed."""
    try:
        import ctypes

        prctl = ctypes.CDLL(None).prctl
    except (ImportError, OSError, AttributeError):
        return None
    set_parent_death_signal = 1  # PR_SET_PDEATHSIG of <sys/prctl.h>

    def request() -> None:
        prctl(set_parent_death_signal, signal.SIGKILL)

    return request
