"""Makes the builds on which a grade depends: in a box, from the sources alone.

No submission shares a build with another submission, or with a second execution of itself. Otherwise the duration of a
build would reveal to a notebook what classmates have handed in, or that it runs for the second time. No submission can
change the build of another one, because no box can write to the folders with builds.

The only builds that submissions share are those of packages that the course itself publishes or makes. They are built
ahead, before any notebook needs them: the course's own programs (``solutions/ros2_ws``), and the packages that the
labs' texts and solutions make (``solutions/*/built_ahead.json``, written by ``python -m tests.measure built_ahead``).
If a package is missing there, or has changed since, each submission builds it for itself, which only costs time.
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
from autograder.workspaces.builds import build_artefacts, build_cache
from autograder.workspaces.builds.cached_builds import Builds, BuildTookTooLong, state
from autograder.workspaces.builds.colcon_build import failed, look
from autograder.workspaces.builds.interface_packages import holds_only_interfaces, simplified
from autograder.workspaces.program_plans import course_interfaces, reference_workspace
from autograder.workspaces.program_preparation import COURSE
from autograder.workspaces.sources import Tree

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from autograder.workspaces.builds.colcon_build import Build
    from autograder.workspaces.jobs import BuildOrder, Jobs
    from autograder.workspaces.packages import Package


ROOM = 32_000_000
"""The maximum size in bytes of all builds of a notebook. An interface package takes two million, a Python package
300,000.
"""


class GradedBuilds(Builds):
    """The builds for one execution of a submission.

    For a package that only defines interfaces, a build made in advance is used even if the student's sources differ in
    comments and spaces.

    Args:
        folder: The folder for the builds of this execution. Only the grader can write to it.
        jobs: Runs colcon and the built programs.
        ahead: The folder of builds made in advance; None if nothing is shared.
        room: The maximum size in bytes of all builds that the execution uses, including builds made in advance.
    """

    def __init__(self, folder: Path, jobs: Jobs, ahead: Path | None = None, room: int = ROOM) -> None:
        super().__init__(folder, jobs, room)
        self._ahead = ahead
        self._paid: set[str] = set()

    def _find_or_make(self, found: Build, chosen: Sequence[Package], order: BuildOrder) -> Build:
        hidden = _hidden_from(chosen)
        others = [f"{path} {state(str(path))}" for path in course_interfaces() if path not in hidden]
        order = self._keyed(replace(order, hidden=hidden), *others)
        wanted = [order]
        if all(map(holds_only_interfaces, chosen)):
            wanted.append(self._keyed(replace(order, tree=simplified(order.tree)), *others))
        for one in wanted:
            if self._ahead and build_cache.is_complete(one.key, self._ahead):
                return self._entry(found, one, self._ahead)
        return self._entry(found, order)

    def _entry(self, found: Build, order: BuildOrder, folder: Path | None = None) -> Build:
        """Return the build, or a failed build if all builds, including those made in advance, exceed the size limit."""
        made = super()._entry(found, order, folder)
        if made.install is None or order.key in self._paid:
            return made
        try:
            build_artefacts.check_room(size := build_cache.size_of(made.install), self._room)
        except build_artefacts.BadArtefacts as error:
            return failed(found, f"error: {error}")
        self._room -= size
        self._paid.add(order.key)
        return made


def _hidden_from(packages: Sequence[Package]) -> Sequence[Path]:
    """Return the files to hide from a build: the course's own interfaces, if the packages define interfaces."""
    return course_interfaces() if any(package.interface_files for package in packages) else ()


FILE = "built_ahead.json"
Files = dict[str, str | None]
"""Packages that are built together: the text of each file by its path relative to ``src``; None for a folder."""
_ROOM = 1_000_000_000
_done: set[Path] = set()


def recorded(root: Path) -> list[Files]:
    """Return the packages in the files ``built_ahead.json`` of all chapters."""
    found: list[Files] = []
    for file in sorted((root / "solutions").glob(f"*/{FILE}")):
        found += msgspec.json.decode(file.read_bytes(), type=list[Files])
    return found


def build_ahead(folder: Path, jobs: Jobs) -> None:
    """Build every shared package that the cache lacks. A second call for the same folder does nothing.

    Args:
        folder: The folder for these builds; see :func:`autograder.workspaces.builds.build_cache.graders_root`.
        jobs: Runs colcon.
    """
    if folder in _done:
        return
    builds = GradedBuilds(folder, jobs, room=_ROOM)
    every: list[Callable[[], object]] = [
        functools.partial(_build, builds, files) for files in recorded(course.root())
    ]
    if (own := reference_workspace()).is_dir():
        every.append(lambda: builds.build(look(own), None, name=COURSE))
    # Begin with a different package in each thread, so that notebooks that start at the same time share the work.
    first = threading.get_native_id() % max(1, len(every))
    for build in (*every[first:], *every[:first]):
        # If a build takes too long, skip it: each submission with this package then builds it for itself.
        with contextlib.suppress(BuildTookTooLong):
            build()
    _done.add(folder)


def _build(builds: GradedBuilds, files: Files) -> object:
    tree = Tree(tuple(Source(path, None if text is None else text.encode()) for path, text in files.items()))
    with HeldFolder("autograder-ahead-") as folder:
        found = _written(tree, folder.path / "as-recorded")
        if all(map(holds_only_interfaces, found.packages)):
            found = _written(simplified(tree), folder.path / "simplified")
        return builds.build(found, None)


def _written(tree: Tree, workspace: Path) -> Build:
    tree.write(workspace / "src")
    return look(workspace)
