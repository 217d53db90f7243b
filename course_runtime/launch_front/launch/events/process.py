"""Events about a process, and events that request something of a process."""

from __future__ import annotations

import signal
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from .base import Event

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

__all__ = [
    "ProcessExited",
    "ProcessIO",
    "ProcessStarted",
    "ProcessStderr",
    "ProcessStdout",
    "RunningProcessEvent",
    "ShutdownProcess",
    "SignalProcess",
]


@dataclass(frozen=True)
class RunningProcessEvent(Event):
    """Something that happened to a process.

    Attributes:
        action: The action that started the process.
        process_name: The name of the process, such as `talker-1`.
        cmd: The command line of the process.
        cwd: The folder in which the process was started; None for the folder of the launch.
        env: The environment of the process.
        pid: The process id.
    """

    action: Any
    process_name: str
    cmd: Sequence[str]
    cwd: str | None
    env: Mapping[str, str] = field(repr=False)
    pid: int


class ProcessStarted(RunningProcessEvent):
    """A process has started."""

    name = "launch.events.process.ProcessStarted"


@dataclass(frozen=True)
class ProcessExited(RunningProcessEvent):
    """A process has ended. A `returncode` below 0 is the negative number of the signal that ended it."""

    returncode: int

    name = "launch.events.process.ProcessExited"


@dataclass(frozen=True)
class ProcessIO(RunningProcessEvent):
    """A process has written something: `text`, in bytes."""

    text: bytes
    from_stdin: bool = False
    from_stdout: bool = False
    from_stderr: bool = False

    name = "launch.events.process.ProcessIO"


class ProcessStdout(ProcessIO):
    """A process has written to stdout."""

    name = "launch.events.process.ProcessStdout"


class ProcessStderr(ProcessIO):
    """A process has written to stderr."""

    name = "launch.events.process.ProcessStderr"


class ShutdownProcess(Event):
    """Requests that a process ends."""

    name = "launch.events.process.ShutdownProcess"

    def __init__(self, *, process_matcher: Callable[[Any], bool]) -> None:
        self.process_matcher = process_matcher


class SignalProcess(Event):
    """Requests that a signal is sent to a process."""

    name = "launch.events.process.SignalProcess"

    def __init__(
        self, *, signal_number: str | signal.Signals, process_matcher: Callable[[Any], bool]
    ) -> None:
        self.signal = (
            signal.Signals[signal_number] if isinstance(signal_number, str) else signal.Signals(signal_number)
        )
        self.process_matcher = process_matcher
