"""Makes the builds on which a grade depends: in a box, from the sources alone.

No submission shares a build with another submission, or with a second execution of itself. Otherwise the duration of a
build would reveal to a notebook what classmates have handed in, or that it runs for the second time. No submission can
change the build of another one, because no box can write to the folders with builds.

The only builds that submissions share are those of packages that the course itself publishes or makes. They are built
ahead, before any notebook needs them: the course's own programs (``solutions/ros2_ws``), and the packages that the
labs' texts and solutions make (``solutions/*/built_ahead.json``, written by ``python -m tests.measure built_ahead``).
If a package is missing there, or has changed since, each submission builds it for itself, which only costs time.

Students write the same three lines of an interface with different comments and spaces. So that they can all use the
build that was made ahead, the sources of packages that only define interfaces are simplified (``simplified_sources``).
"""

from __future__ import annotations

import contextlib
import functools
import threading
from dataclasses import replace
from typing import TYPE_CHECKING

import msgspec

from autograder import course
from autograder.messages.workspace_messages import Source
from autograder.safe_files import HeldFolder
from autograder.workspaces.builds import build_artifacts, build_cache
from autograder.workspaces.builds.cached_builds import Builds, BuildTookTooLong, file_state
from autograder.workspaces.builds.colcon_build import describe_workspace, failed_build
from autograder.workspaces.builds.simplified_sources import simplified
from autograder.workspaces.packages import DEFINITIONS
from autograder.workspaces.program_plans import course_interfaces, reference_workspace
from autograder.workspaces.program_preparation import COURSE
from autograder.workspaces.sources import SourceTree

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from autograder.workspaces.builds.colcon_build import Build
    from autograder.workspaces.jobs import BuildJob, Jobs


ROOM = 32_000_000
"""The maximum size in bytes of all builds of a notebook. An interface package takes two million, a Python package
300,000.
"""


class GradedBuilds(Builds):
    """The builds for one execution of a submission.

    Args:
        folder: The folder for the builds of this execution. Only the grader can write to it.
        jobs: Runs colcon and the built programs.
        ahead: The folder of builds made in advance; None if nothing is shared. If it is ``folder``, they are made.
        room: The maximum size in bytes of all builds that the execution uses, including builds made in advance.
    """

    def __init__(self, folder: Path, jobs: Jobs, ahead: Path | None = None, room: int = ROOM) -> None:
        super().__init__(folder, jobs, room)
        self._ahead = ahead
        self._paid: set[str] = set()

    def _keyed(self, job: BuildJob, *words: str) -> BuildJob:
        # If the packages define interfaces, hide the course's interfaces from the build.
        hides = any(source.path.endswith(DEFINITIONS) for source in job.tree.sources)
        found = [] if hides else [f"{path} {file_state(str(path))}" for path in course_interfaces()]
        return super()._keyed(replace(job, hidden=course_interfaces() if hides else ()), *found, *words)

    def _entry(self, found: Build, job: BuildJob, folder: Path | None = None) -> Build:
        """Return the build, or a failed build if all builds, including those made in advance, exceed the size limit."""
        names = {package.name for package in job.packages}
        interfaces = all(p.holds_only_interfaces for p in found.packages if p.name in names)
        shared = self._keyed(replace(job, tree=simplified(job.tree))) if interfaces else job
        if self._ahead and (self._ahead == self._folder or build_cache.is_complete(shared.key, self._ahead)):
            job, folder = shared, self._ahead
        made = super()._entry(found, job, folder)
        if made.install is None or job.key in self._paid:
            return made
        try:
            build_artifacts.check_room(size := build_cache.size_of(made.install), self._room)
        except build_artifacts.BadArtifacts as error:
            return failed_build(found, f"error: {error}")
        self._room -= size
        self._paid.add(job.key)
        return made


BUILT_AHEAD = "built_ahead.json"
"""The name of a chapter's file with the packages to build ahead."""
PackageFiles = dict[str, str | None]
"""Packages that are built together: the text of each file by its path relative to ``src``; None for a folder."""
_ROOM_AHEAD = 1_000_000_000
_done: set[Path] = set()


def packages_to_build_ahead(root: Path) -> list[PackageFiles]:
    """Return the packages in the files ``built_ahead.json`` of all chapters."""
    found: list[PackageFiles] = []
    for file in sorted((root / "solutions").glob(f"*/{BUILT_AHEAD}")):
        found += msgspec.json.decode(file.read_bytes(), type=list[PackageFiles])
    return found


def build_ahead(folder: Path, jobs: Jobs) -> None:
    """Build every shared package that the cache lacks. A second call for the same folder does nothing.

    Args:
        folder: The folder for these builds; see :func:`autograder.workspaces.builds.build_cache.graders_root`.
        jobs: Runs colcon.
    """
    if folder in _done:
        return
    builds = GradedBuilds(folder, jobs, folder, room=_ROOM_AHEAD)
    every: list[Callable[[], object]] = [
        functools.partial(_build, builds, files) for files in packages_to_build_ahead(course.root())
    ]
    if (own := reference_workspace()).is_dir():
        every.append(lambda: builds.build(describe_workspace(own), None, name=COURSE))
    # Begin with a different package in each thread, so that notebooks that start at the same time share the work.
    first = threading.get_native_id() % max(1, len(every))
    for build in (*every[first:], *every[:first]):
        # If a build takes too long, skip it: each submission with this package then builds it for itself.
        with contextlib.suppress(BuildTookTooLong):
            build()
    _done.add(folder)


def _build(builds: GradedBuilds, files: PackageFiles) -> object:
    """Build packages that the course has recorded."""
    sources = (Source(path, None if text is None else text.encode()) for path, text in files.items())
    with HeldFolder("autograder-ahead-") as folder:
        SourceTree(tuple(sources)).write(folder.path / "src")
        return builds.build(describe_workspace(folder.path), None)
