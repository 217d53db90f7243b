"""One run of a path as a subject: the workspace is built, or the launch file launched, in a process of its own."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

from autograder.workspaces.finding import workspace_of
from autograder.workspaces.processes import descendants
from autograder.workspaces.sources import BadSources, Source, collect_launch, collect_workspace

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from autograder.notebook.subject_run import Tell

POLITE = 1.5
"""Seconds of wall time that the programs have to end after an interrupt, before they are killed."""
MAX_LINE = 4_000
"""Bytes of one line of output."""


class PathRun:
    """Runs ``python -m autograder.workspaces`` on a path once, on the domain of the check."""

    def __init__(
        self, number: int, exercise: str, path: str | os.PathLike[str], domain: int, tell: Tell
    ) -> None:
        self._number = number
        self._command = [sys.executable, "-m", "autograder.workspaces", exercise, os.fspath(path)]
        self._domain = domain
        self._tell_judge = tell
        self._process: subprocess.Popen[bytes] | None = None
        self._reader: threading.Thread | None = None

    def start(self, arguments: Sequence[Any], options: Mapping[str, Any]) -> None:
        """Start the process; a path takes no arguments and no options."""
        del arguments, options
        self._process = subprocess.Popen(
            self._command,
            env=_environment(self._domain),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            # Interrupting the kernel must not end it halfway: the judge says when it ends.
            start_new_session=True,
        )
        self._reader = threading.Thread(target=self._follow, args=(self._process,), daemon=True)
        self._reader.start()

    def release(self) -> None:
        """A process runs from its start."""

    def stop(self) -> bool:
        """End the process with all that it started."""
        process = self._process
        if process is None:
            return True
        family = [process.pid, *descendants(process.pid)] if process.poll() is None else []
        if family:
            _signal(-process.pid, signal.SIGINT)
            try:
                process.wait(timeout=POLITE)
            except subprocess.TimeoutExpired:
                family += descendants(process.pid)
        # Also what has moved into a process group of its own, as a launch's nodes do.
        for pid in family:
            if _is_session_of(pid, process.pid):
                _signal(pid, signal.SIGKILL)
        _signal(-process.pid, signal.SIGKILL)
        process.wait()
        if self._reader is not None:
            self._reader.join(timeout=POLITE)
        return True

    def _follow(self, process: subprocess.Popen[bytes]) -> None:
        assert process.stdout is not None
        with process.stdout as stream:
            self._pass_on(stream)
        self._tell_judge("exited", run=self._number, code=process.wait())

    def _pass_on(self, stream: IO[bytes]) -> None:
        while line := stream.readline(MAX_LINE):
            text = line.decode("utf-8", "replace").rstrip("\r\n")
            self._tell_judge("output", run=self._number, text=text)


def is_path(subject: object) -> bool:
    """Whether a subject is a path: a text or a ``pathlib.Path``."""
    return isinstance(subject, (str, Path))


def send_sources(tell: Tell, subject: object) -> None:
    """Tell a grader's judge what it asks for: everything that a check of this path may need.

    Args:
        tell: Tells the judge.
        subject: What the check cell was given; of what is no path there are no sources.
    """
    path, sent, trouble = "nothing", list[Source](), ""
    try:
        if not isinstance(subject, (str, Path)):
            raise BadSources(f"check(...) takes the path of files here, not a {type(subject).__name__}")
        file = Path(subject)
        if file.suffix and not file.is_dir():
            path, sent = collect_launch(file, workspace_of(file, (file.resolve().parent, Path.cwd())))
        else:
            path, sent = file.resolve().name or "nothing", collect_workspace(file)
    except (BadSources, OSError) as error:
        trouble = str(error)
    for source in sent:
        tell("source", **source.as_words())
    tell("sources", path=path, trouble=trouble)


def _environment(domain: int) -> dict[str, str]:
    """The kernel's own environment, on the domain of the check and on its transport."""
    return {
        **os.environ,
        "ROS_DOMAIN_ID": str(domain),
        "FASTDDS_BUILTIN_TRANSPORTS": "UDPv4",
        "PYTHONUNBUFFERED": "1",
    }


def _signal(pid: int, number: int) -> None:
    try:
        if pid < 0:
            os.killpg(-pid, number)
        else:
            os.kill(pid, number)
    except (ProcessLookupError, PermissionError):
        pass


def _is_session_of(pid: int, leader: int) -> bool:
    """Whether a process still belongs to the session: its number may be another program's by now."""
    try:
        return os.getsid(pid) == leader
    except OSError:
        return False
