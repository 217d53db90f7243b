"""The jobs that the grader's trusted side has done for it: build a student's sources, run what was built."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

from autograder.workspaces.building.jobs import Builder

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

BUILD_SECONDS = 170.0
"""Wall time in which a build must have ended; an interface package takes five on two idle cores. Less than an exercise
waits for it, so that a machine that is too busy is never taken for a build that failed."""
MAX_LOG_BYTES = 1_000_000
"""Output that is kept of a build."""
MAX_ARCHIVE_BYTES = 64_000_000
"""All that a build may have made, as an archive; an interface package has 1.3 million."""


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
        """What it has said meanwhile; None for nothing yet, no bytes at its end.

        Args:
            within: Seconds to wait for something.
        """
        ...

    def exit_code(self) -> int | None:
        """How it ended, once it has; negative for a signal."""
        ...

    def interrupt(self) -> None:
        """Ctrl-C, as a terminal sends it: to the program and to what it has started."""
        ...

    def end(self) -> None:
        """Kill it and all that it has started; may be called twice."""
        ...


class Jobs(Builder, Protocol):
    """Builds and runs for one submission."""

    @property
    def environment(self) -> Mapping[str, str]:
        """The whole environment of a job, before anything is added to it."""
        ...

    def tree(self, sources: Path) -> Path:
        """Where programs see the folder with what was submitted."""
        ...

    def start(self, job: ProgramJob) -> Program:
        """Run a program where the judge can see it on the wire, and the notebook cannot."""
        ...
