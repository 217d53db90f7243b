"""Runs jobs as this user's processes: in a notebook, in a terminal, and for a grader that may work without boxes.

The reports are the same as with boxes, but nothing isolates a build or program from the process that runs it.
"""

from __future__ import annotations

import subprocess
import sys
from typing import TYPE_CHECKING

from autograder.temporary_folders import HeldFolder
from autograder.workspaces.builds.artefacts import pack
from autograder.workspaces.builds.install_folder import BESIDE, without_workspaces
from autograder.workspaces.running.jobs import BUILD_SECONDS, MAX_LOG_BYTES, Built
from autograder.workspaces.running.own_session import OwnSession

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from autograder.workspaces.builds.cache import CachedBuild
    from autograder.workspaces.running.jobs import BuildOrder, ProgramJob

OWN_BUILD_SECONDS = 300.0
"""The time limit of a build of the student's own workspace, in seconds of wall time."""


class PlainJobs:
    """Runs jobs as this user's processes; implements :class:`autograder.workspaces.running.jobs.Jobs`.

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

    def build(self, order: BuildOrder, command: Sequence[str], entry: CachedBuild) -> Built:
        """Run a build in the folder of the entry. For a submission, pack the install folder and then remove it."""
        seconds, size = (
            (BUILD_SECONDS, MAX_LOG_BYTES) if self._handed_in else (OWN_BUILD_SECONDS, sys.maxsize)
        )
        environment = {**without_workspaces(self.environment, order.workspace), **order.variables}
        # Remove this variable, because with it setuptools would print a warning in every log.
        environment.pop("PYTHONDONTWRITEBYTECODE", None)
        start = PlainProgram if self._handed_in else OwnSession
        with start(command, environment, entry.folder, (entry.lock,)) as colcon:
            output, late = colcon.collect(seconds, size, order.cancelled)
            code = colcon.exit_code()
        archive = pack(entry.folder / "install") if self._handed_in and code == 0 else None
        made = (*BESIDE, "install") if self._handed_in else BESIDE
        # Use rm, because the folders may be nested more deeply than Python's recursion allows.
        subprocess.run(["rm", "-rf", *(str(entry.folder / name) for name in made)], check=False)
        return Built(code, output, archive, late=seconds if late else 0.0)

    def start(self, job: ProgramJob) -> PlainProgram:
        """Start the program as a process."""
        return PlainProgram(job.command, job.environment, job.sources)


class PlainProgram(OwnSession):
    """A program with its own home and temporary folders (:class:`autograder.workspaces.running.jobs.Program`)."""

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
