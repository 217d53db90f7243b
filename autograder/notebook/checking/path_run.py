"""One run of a workspace or launch file as a subject, in a separate process that builds or launches it."""

from __future__ import annotations

import os
import threading
from pathlib import Path
from typing import TYPE_CHECKING, Any

from autograder.messages.checks import Exited, Output, Sources
from autograder.messages.workspaces import Source
from autograder.workspaces.packages import workspace_of
from autograder.workspaces.running.jobs import output_lines
from autograder.workspaces.running.own_session import OwnSession
from autograder.workspaces.sources import BadSources, collect_launch, collect_workspace
from environment.python_child import python_child

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from autograder.notebook.checking.subject_run import Tell

POLITE = 1.5
"""Time limit in seconds of wall time for programs to end after an interrupt. Then they are killed."""


class PathRun:
    """Runs ``python -m autograder.workspaces PATH`` once, on the ROS domain of the check."""

    def __init__(
        self, number: int, exercise: str, path: str | os.PathLike[str], domain: int, tell: Tell
    ) -> None:
        self._number = number
        self._command = python_child("-m", "autograder.workspaces", exercise, os.fspath(path)).command
        self._domain = domain
        self._tell = tell
        self._program: OwnSession | None = None
        self._reader: threading.Thread | None = None

    def start(self, arguments: Sequence[Any], options: Mapping[str, Any]) -> None:
        """Start the process for one run.

        Args:
            arguments: If the exercise has several programs, the name of one and its arguments; otherwise nothing.
            options: Always empty, because only a function or a node has options.
        """
        del options
        # The process gets its own session, so that interrupting the kernel does not end it. The judge decides when it
        # ends.
        self._program = OwnSession([*self._command, *map(str, arguments)], _environment(self._domain))
        self._reader = threading.Thread(target=self._follow, args=(self._program,), daemon=True)
        self._reader.start()

    def release(self) -> None:
        """Do nothing: a process runs on by itself after :meth:`start`. Only a node waits for this call."""

    def interrupt(self) -> None:
        """Send Ctrl-C to the process, as in a terminal."""
        if self._program is not None:
            self._program.interrupt()

    def stop(self) -> bool:
        """End the process and everything that it has started. Return True."""
        if self._program is not None:
            self._program.end(POLITE)
        if self._reader is not None:
            self._reader.join(timeout=POLITE)
        return True

    def _follow(self, program: OwnSession) -> None:
        with program:
            for text in output_lines(program, within=POLITE):
                self._tell(Output(self._number, text))
        self._tell(Exited(self._number, program.wait()))


def is_path(subject: object) -> bool:
    """Return True if a subject is a path: a string or a ``pathlib.Path``."""
    return isinstance(subject, (str, Path))


def send_sources(tell: Tell, subject: object) -> None:
    """Send the grader's judge all source files that a check of this workspace or launch file may need.

    Args:
        tell: Sends a message to the judge.
        subject: The argument of the check cell. Only a path has sources.
    """
    path, sent, trouble = "nothing", list[Source](), ""
    try:
        if not isinstance(subject, (str, Path)):
            raise BadSources(
                f"check(...) takes the path of a workspace or launch file here, not a {type(subject).__name__}"
            )
        file = Path(subject)
        if file.suffix and not file.is_dir():
            path, sent = collect_launch(file, workspace_of(file, (file.resolve().parent, Path.cwd())))
        else:
            path, sent = file.resolve().name or "nothing", collect_workspace(file)
    except (BadSources, OSError) as error:
        trouble = str(error)
    for source in sent:
        tell(source)
    tell(Sources(path, trouble))


def _environment(domain: int) -> dict[str, str]:
    """Return the kernel's environment variables, with the ROS domain and the DDS transport of the check."""
    return {
        **os.environ,
        "ROS_DOMAIN_ID": str(domain),
        "FASTDDS_BUILTIN_TRANSPORTS": "UDPv4",
        "PYTHONUNBUFFERED": "1",
    }
