"""Builds and programs as jobs: what they are told, what comes of them, and who runs them, here or in a box.

Whatever a build does, it only ever yields bytes: output, and the files that it left in its install folder. Nothing of
it is executed or unpickled by who has asked for it.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Protocol

from autograder.standard_output import split_lines

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence
    from pathlib import Path

    from autograder.workspaces.cache import Entry
    from autograder.workspaces.packages import Package
    from autograder.workspaces.sources import Tree

BUILD_SECONDS = 170.0
"""Wall time in which a build must have ended; an interface package takes five on two idle cores. Less than an exercise
waits for it, so that a machine that is too busy is never taken for a build that failed."""
MAX_LOG_BYTES = 1_000_000
"""Output that is kept of a build."""
MAX_LINE = 4_000
"""Bytes of one line of a program's output that are passed on."""
MAX_ARCHIVE_BYTES = 64_000_000
"""All that a build may have made, as an archive; an interface package has 1.3 million."""


@dataclass(frozen=True)
class BuildOrder:
    """A build that is wanted.

    Attributes:
        name: See :meth:`Jobs.place`.
        workspace: What is in this folder is not found by the build.
        tree: What the build gets to see, in ``src`` of its place.
        packages: The packages in it; their folders are relative to the place.
        cancelled: Asked now and then; the build is ended when it says so.
        cmake: More arguments for CMake.
        variables: More variables of its environment.
        hidden: Files and folders of the environment that it must not find.
        key: Stands for all this and for the tools.
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
    """The end of a build.

    Attributes:
        returncode: Of colcon; None where it was ended, at a limit or because nobody waits for it any more.
        output: What it said.
        archive: Its install folder as a tar file, made once nothing of the build was alive any more, and empty where
            it could not be packed; None where the build failed, or was made in the entry itself.
        late: The seconds after which it was ended because it took too long, which may be the machine's fault; else 0.
    """

    returncode: int | None
    output: bytes
    archive: bytes | None = field(default=None, repr=False)
    late: float = 0.0


@dataclass(frozen=True)
class ProgramJob:
    """A program that is to run.

    Attributes:
        command: Names everything as it is seen from the job.
        environment: Its whole environment.
        sources: What was submitted; seen at :meth:`Jobs.tree`, which is where the program starts.
        entries: Builds that it may read, by the names of their places.
        hidden: Files and folders of the environment that the program must not find.
    """

    command: Sequence[str]
    environment: Mapping[str, str]
    sources: Path
    entries: Mapping[str, Path]
    hidden: Sequence[Path]


class Program(Protocol):
    """A program that runs."""

    pid: int
    """The process that all its processes are below of, as the host counts."""

    def read(self, within: float) -> bytes | None:
        """Its output since the last call; None for nothing yet, no bytes at its end.

        Args:
            within: Seconds to wait for something.
        """
        ...

    def exit_code(self) -> int | None:
        """Its exit code once it has ended; negative for a signal."""
        ...

    def interrupt(self) -> None:
        """Ctrl-C, as a terminal sends it: to the program and to what it has started."""
        ...

    def end(self) -> None:
        """Kill it and all that it has started; may be called twice."""
        ...


def output_lines(
    program: Program, wanted: Callable[[], bool] = lambda: True, within: float = 0.1
) -> Iterator[str]:
    """The lines of a program's output as they come, to its end or as long as they are wanted; long ones are cut.

    Args:
        program: The program.
        wanted: Asked now and then.
        within: Seconds between two questions where nothing comes.
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
        """The whole environment of a job, before anything is added to it."""
        ...

    def place(self, name: str, entry: Path) -> Path:
        """The path at which jobs see a folder of the cache of builds.

        Args:
            name: What stands for the kind of workspace, such as ``"ros2_ws"``: each has a place of its own.
            entry: The folder.
        """
        ...

    def build(self, order: BuildOrder, command: Sequence[str], entry: Entry) -> Built:
        """Run colcon.

        Args:
            order: What is wanted.
            command: Names everything as it is seen from the job.
            entry: Its folder holds ``src``, which the build may read. All that it writes is gone afterwards, but for
                ``install`` of the place.
        """
        ...

    def tree(self, sources: Path) -> Path:
        """The path at which programs see the folder with what was submitted."""
        ...

    def start(self, job: ProgramJob) -> Program:
        """Run a program where the judge can see it on the wire, and the notebook cannot."""
        ...
