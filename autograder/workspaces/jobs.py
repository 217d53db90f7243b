"""Jobs (builds and programs): what to run, the results, and the class that runs jobs without boxes.

The result of a build is only bytes: its output, and the files in its install folder. These bytes may come from a
student's code, so the process that asked for the build never executes or unpickles them.

Without boxes, jobs run as this user's processes: in a notebook, in a terminal, and for a grader that may work without
boxes. The reports are the same as with boxes, but nothing isolates a build or program from the process that runs it.
"""

from __future__ import annotations

import subprocess
import sys
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Protocol

from autograder.safe_files import HeldFolder
from autograder.standard_output import collect, split_lines
from autograder.workspaces.builds.build_artifacts import pack
from autograder.workspaces.builds.install_folder import BESIDE, without_workspaces
from autograder.workspaces.own_session import OwnSession

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence
    from pathlib import Path

    from autograder.workspaces.builds.build_cache import CachedBuild
    from autograder.workspaces.packages import Package
    from autograder.workspaces.sources import SourceTree


BUILD_SECONDS = 170.0
"""The time limit of a build, in seconds of wall time. An interface package takes five seconds on two idle cores.

An exercise waits longer than this, so that a build on a busy machine is never mistaken for a failed build.
"""
MAX_LOG_BYTES = 1_000_000
"""The maximum number of bytes that are kept of a build's output."""
MAX_ARCHIVE_BYTES = 64_000_000
"""The maximum size in bytes of the archive of everything that a build makes; an interface package has 1.3 million
bytes.
"""


@dataclass(frozen=True)
class BuildJob:
    """A build to make.

    Attributes:
        name: The kind of workspace; see :meth:`Jobs.place`.
        workspace: The student's workspace, whose earlier results must not influence the build.
        tree: The sources of the build. They are put into ``src`` of the build's folder.
        packages: The packages in the sources. Their folders are relative to the build's folder.
        cancelled: Called from time to time. If it returns True, the build is ended.
        cmake: More arguments for CMake.
        variables: More environment variables.
        hidden: Files and folders of the environment that the build must not find.
        key: A hash of the whole job and of the tools.
    """

    name: str
    workspace: Path
    tree: SourceTree
    packages: Sequence[Package]
    cancelled: Callable[[], bool]
    cmake: Sequence[str] = ()
    variables: Mapping[str, str] = field(default_factory=dict)
    hidden: Sequence[Path] = ()
    key: str = ""


@dataclass(frozen=True)
class BuildOutcome:
    """The result of a build.

    Attributes:
        returncode: colcon's exit code; None if the build was stopped, at a limit or because it was no longer needed.
        output: The output of the build.
        archive: The install folder as :func:`autograder.workspaces.builds.build_artifacts.pack` packed it, after all
            processes of the build had ended. It is empty if it could not be packed, and None if the build failed or
            was made in the cache entry itself.
        late: The number of seconds after which the build was stopped as too long, perhaps because the machine was
            busy; else 0.
    """

    returncode: int | None
    output: bytes
    archive: bytes | None = field(default=None, repr=False)
    late: float = 0.0


@dataclass(frozen=True)
class ProgramJob:
    """A program to run.

    Attributes:
        command: The command, with paths as the program sees them.
        environment: All environment variables.
        sources: The folder of the submitted files. The program sees it at :meth:`Jobs.tree`, which is also its
            working folder.
        entries: The folders of the builds that the program may read, by kind of workspace (see :meth:`Jobs.place`).
        hidden: Files and folders of the environment that the program must not find.
    """

    command: Sequence[str]
    environment: Mapping[str, str]
    sources: Path
    entries: Mapping[str, Path]
    hidden: Sequence[Path]


class Jobs(Protocol):
    """Runs builds and programs, as processes (:class:`PlainJobs`) or in boxes (``boxed_jobs.py``)."""

    @property
    def environment(self) -> Mapping[str, str]:
        """The environment variables of all jobs, to which the variables of each job are added."""
        ...

    def place(self, name: str, entry: Path) -> Path:
        """Return the path at which jobs see a folder of the build cache.

        Args:
            name: The kind of workspace, such as ``"ros2_ws"``. Each kind is seen at its own path.
            entry: The folder of the cache.
        """
        ...

    def build(self, job: BuildJob, command: Sequence[str], entry: CachedBuild) -> BuildOutcome:
        """Run colcon. Return the result of the build.

        Args:
            job: The build to make.
            command: The command, with paths as the job sees them.
            entry: The entry of the cache. Its folder contains ``src``, which the build may read. Of the files that
                the build writes, only ``install`` is kept.
        """
        ...

    def tree(self, sources: Path) -> Path:
        """Return the path at which programs see the folder of submitted files."""
        ...

    def start(self, job: ProgramJob) -> RunningProgram:
        """Run a program on a network that the judge can see and the notebook cannot."""
        ...


class RunningProgram(Protocol):
    """A program that :meth:`Jobs.start` has started."""

    pid: int
    """The process id, as seen outside the sandbox, of the program's first process, from which its other processes
    descend.
    """

    def read(self, within: float) -> bytes | None:
        """Return the output since the last call; None if nothing has come yet, b"" at the end.

        Args:
            within: The maximum number of seconds to wait for output.
        """
        ...

    def exit_code(self) -> int | None:
        """Return the exit code once the program has ended; negative if a signal ended it."""
        ...

    def interrupt(self) -> None:
        """Send Ctrl-C as a terminal does: to the program and to the processes that it has started."""
        ...

    def end(self) -> None:
        """Kill the program and everything that it has started. This may be called twice."""
        ...


OWN_BUILD_SECONDS = 300.0
"""The time limit of a build of the student's own workspace, in seconds of wall time."""


class PlainJobs:
    """Runs jobs as this user's processes; implements :class:`Jobs`.

    Args:
        environment: The environment of the jobs.
        handed_in: True if the code is a submission. In that case jobs get a separate home folder, and the result of a
            build is packed into an archive.
    """

    def __init__(self, environment: Mapping[str, str], *, handed_in: bool) -> None:
        self.environment: Mapping[str, str] = dict(environment)
        self._handed_in = handed_in

    def place(self, name: str, entry: Path) -> Path:
        """Return the path of the entry. Without a box, jobs see the entry at its own path."""
        del name
        return entry

    def tree(self, sources: Path) -> Path:
        """Return the path of the sources. Without a box, programs see the sources at their own path."""
        return sources

    def build(self, job: BuildJob, command: Sequence[str], entry: CachedBuild) -> BuildOutcome:
        """Run a build in the folder of the entry. For a submission, pack the install folder and then remove it."""
        seconds, size = (
            (BUILD_SECONDS, MAX_LOG_BYTES) if self._handed_in else (OWN_BUILD_SECONDS, sys.maxsize)
        )
        environment = {**without_workspaces(self.environment, job.workspace), **job.variables}
        # Remove this variable, because with it setuptools would print a warning in every log.
        environment.pop("PYTHONDONTWRITEBYTECODE", None)
        start = PlainProgram if self._handed_in else OwnSession
        with start(command, environment, entry.folder, (entry.lock,)) as colcon:
            said = collect(colcon, seconds, size, job.cancelled)
            code = colcon.exit_code()
        archive = pack(entry.folder / "install") if self._handed_in and code == 0 else None
        made = (*BESIDE, "install") if self._handed_in else BESIDE
        # Use rm, because the folders may be nested more deeply than Python's recursion allows.
        subprocess.run(["rm", "-rf", *(str(entry.folder / name) for name in made)], check=False)
        return BuildOutcome(code, said.output, archive, late=seconds if said.late else 0.0)

    def start(self, job: ProgramJob) -> PlainProgram:
        """Start the program as a process."""
        return PlainProgram(job.command, job.environment, job.sources)


class PlainProgram(OwnSession):
    """A program with its own home and temporary folders; implements :class:`RunningProgram`."""

    def __init__(
        self, command: Sequence[str], environment: Mapping[str, str], cwd: Path, holds: Sequence[int] = ()
    ) -> None:
        self._home = HeldFolder("autograder-job-")
        folders = dict.fromkeys(("HOME", "TMPDIR", "ROS_LOG_DIR"), str(self._home.path))
        super().__init__(command, {**environment, **folders}, cwd, holds)

    def end(self, polite: float = 0.0) -> None:
        """Kill the program, and remove its files."""
        super().end(polite)
        self._output.close()
        self._home.remove()


MAX_LINE = 4_000
"""The maximum length of a line of a program's output, in bytes."""


def output_lines(
    program: RunningProgram, wanted: Callable[[], bool] = lambda: True, within: float = 0.1
) -> Iterator[str]:
    """Yield the lines of a program's output until the output ends or is no longer needed. Long lines are cut.

    Args:
        wanted: Called from time to time. If it returns False, no more lines are yielded.
        within: Seconds between these calls while there is no output.
    """
    line = b""
    while wanted() and (data := program.read(within)) != b"":
        *complete, line = split_lines(line + (data or b""))
        yield from map(_as_text, complete)
        line = line[:MAX_LINE]
    if line:
        yield _as_text(line)


def _as_text(line: bytes) -> str:
    return line[:MAX_LINE].decode("utf-8", "replace").rstrip("\r")
