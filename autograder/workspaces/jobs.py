"""Builds and programs as jobs: their orders, their results, and the interface of what runs them, here or in a box.

A build yields nothing but bytes: output, and the files in its install folder. The caller never executes or unpickles
any of it.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Protocol

from autograder.standard_output import split_lines

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence
    from pathlib import Path

    from autograder.workspaces.cache import CachedBuild
    from autograder.workspaces.packages import Package
    from autograder.workspaces.sources import Tree

BUILD_SECONDS = 170.0
"""The time limit of a build in seconds of wall time; an interface package takes five on two idle cores.

An exercise waits longer than this, so that a busy machine is never taken for a failed build.
"""
MAX_LOG_BYTES = 1_000_000
"""The limit on the kept output of a build, in bytes."""
MAX_LINE = 4_000
"""The limit on one line of a program's output, in bytes."""
MAX_ARCHIVE_BYTES = 64_000_000
"""The limit on everything that a build makes, as an archive; an interface package has 1.3 million bytes."""


@dataclass(frozen=True)
class BuildOrder:
    """An order for a build.

    Attributes:
        name: See :meth:`Jobs.place`.
        workspace: A folder whose content the build must not find.
        tree: The sources of the build, in ``src`` of its place.
        packages: The packages in the sources; their folders are relative to the place.
        cancelled: Called from time to time; the build is ended when it returns True.
        cmake: More arguments for CMake.
        variables: More environment variables.
        hidden: Files and folders of the environment that the build must not find.
        key: A hash of all this and of the tools.
    """

    name: str
    workspace: Path
    tree: Tree
    packages: Sequence[Package]
    cancelled: Callable[[], bool]
    cmake: Sequence[str] = ()
    variables: Mapping[str, str] = field(default_factory=dict)
    hidden: Sequence[Path] = ()
    key: str = ""


@dataclass(frozen=True)
class Built:
    """The result of a build.

    Attributes:
        returncode: colcon's exit code; None if the build was stopped, at a limit or because it was no longer wanted.
        output: The output of the build.
        archive: The install folder as a tar file, made when no process of the build was alive any more; empty if it
            could not be packed; None if the build failed, or was made in the entry itself.
        late: The seconds after which a too long build was stopped, perhaps because the machine was busy; else 0.
    """

    returncode: int | None
    output: bytes
    archive: bytes | None = field(default=None, repr=False)
    late: float = 0.0


@dataclass(frozen=True)
class ProgramJob:
    """A program to run.

    Attributes:
        command: The command, with paths as the job sees them.
        environment: All environment variables.
        sources: The submitted files; the job sees them at :meth:`Jobs.tree`, which is also the working folder.
        entries: Builds that the program may read, by the names of their places.
        hidden: Files and folders of the environment that the program must not find.
    """

    command: Sequence[str]
    environment: Mapping[str, str]
    sources: Path
    entries: Mapping[str, Path]
    hidden: Sequence[Path]


class Program(Protocol):
    """A running program."""

    pid: int
    """The number, outside the sandbox, of the first process of the job: all others descend from it."""

    def read(self, within: float) -> bytes | None:
        """Return the output since the last call; None for nothing yet, b"" at its end.

        Args:
            within: Seconds to wait for output.
        """
        ...

    def exit_code(self) -> int | None:
        """The exit code once the program has ended; negative for a signal."""
        ...

    def interrupt(self) -> None:
        """Send Ctrl-C as a terminal does: to the program and to what it has started."""
        ...

    def end(self) -> None:
        """Kill the program and everything that it has started; may be called twice."""
        ...


def output_lines(
    program: Program, wanted: Callable[[], bool] = lambda: True, within: float = 0.1
) -> Iterator[str]:
    """Yield the lines of a program's output, until it ends or they are no longer wanted; long lines are cut.

    Args:
        program: The program.
        wanted: Called from time to time; False ends the lines.
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


class Jobs(Protocol):
    """Builds and runs, here (:mod:`autograder.workspaces.plain_jobs`) or in boxes (``boxed_jobs``)."""

    @property
    def environment(self) -> Mapping[str, str]:
        """The whole environment of a job, before variables are added."""
        ...

    def place(self, name: str, entry: Path) -> Path:
        """Return the path at which jobs see a folder of the cache of builds.

        Args:
            name: The kind of workspace, such as ``"ros2_ws"``: each kind has its own place.
            entry: The folder.
        """
        ...

    def build(self, order: BuildOrder, command: Sequence[str], entry: CachedBuild) -> Built:
        """Run colcon.

        Args:
            order: The order.
            command: The command, with paths as the job sees them.
            entry: Its folder contains ``src``, which the build may read. Of the files that the build writes, only
                ``install`` in the place is kept.
        """
        ...

    def tree(self, sources: Path) -> Path:
        """Return the path at which programs see the folder of submitted files."""
        ...

    def start(self, job: ProgramJob) -> Program:
        """Run a program on a network that the judge can see and the notebook cannot."""
        ...
