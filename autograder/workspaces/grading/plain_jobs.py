"""Jobs without boxes, for a grader that was told to go on without a sandbox.

Reports are made as with boxes, but nothing keeps a build or a program away from who makes them.
"""

from __future__ import annotations

import io
import subprocess
import tarfile
import tempfile
from dataclasses import replace
from typing import TYPE_CHECKING

from autograder.workspaces.building.own import run
from autograder.workspaces.jobs import BUILD_SECONDS, MAX_LOG_BYTES
from autograder.workspaces.running.own_session import OwnSession

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from autograder.workspaces.building.cache import Entry
    from autograder.workspaces.jobs import BuildOrder, Built, ProgramJob


class PlainJobs:
    """Implements :class:`autograder.workspaces.jobs.Jobs`.

    Args:
        environment: The whole environment of what is run.
    """

    def __init__(self, environment: Mapping[str, str]) -> None:
        self._environment = dict(environment)

    @property
    def environment(self) -> Mapping[str, str]:
        """The environment that this was made with."""
        return self._environment

    def place(self, name: str, entry: Path) -> Path:
        """The entry itself."""
        del name
        return entry

    def tree(self, sources: Path) -> Path:
        """The sources themselves."""
        return sources

    def build(self, order: BuildOrder, command: Sequence[str], entry: Entry) -> Built:
        """Build in the entry, pack what came of it and remove that again."""
        program = PlainProgram(command, {**self._environment, **order.variables}, entry.folder)
        built = run(program, order, entry, BUILD_SECONDS, MAX_LOG_BYTES)
        if built.returncode != 0:
            return built
        archive = io.BytesIO()
        with tarfile.open(fileobj=archive, mode="w") as tar:
            tar.add(entry.folder / "install", arcname=".")
        for made in ("install", "build", "log"):
            subprocess.run(["rm", "-rf", str(entry.folder / made)], check=True)
        return replace(built, archive=archive.getvalue())

    def start(self, job: ProgramJob) -> PlainProgram:
        """Start it as a process."""
        return PlainProgram(job.command, job.environment, job.sources)


class PlainProgram(OwnSession):
    """Implements :class:`autograder.workspaces.jobs.Program`: its home and temporary files are its own."""

    def __init__(self, command: Sequence[str], environment: Mapping[str, str], cwd: Path) -> None:
        self._home = tempfile.TemporaryDirectory(prefix="job-", ignore_cleanup_errors=True)
        folders = dict.fromkeys(("HOME", "TMPDIR", "ROS_LOG_DIR"), self._home.name)
        super().__init__(command, {**environment, **folders}, cwd)

    def end(self, polite: float = 0.0) -> None:
        """Kill it, and take its files away."""
        super().end(polite)
        self.output.close()
        self._home.cleanup()
