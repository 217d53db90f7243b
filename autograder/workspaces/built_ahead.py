"""Builds the course's own packages before any notebook needs them; all submissions share these builds.

The packages are the course's own programs (``solutions/ros2_ws``), and those that the labs' texts and solutions make
(``solutions/*/built_ahead.json``, written by ``python -m tests.measure built_ahead``). If a package is missing there,
or has changed since, each submission builds it for itself, which only costs time.
"""

from __future__ import annotations

import contextlib
import functools
import threading
from typing import TYPE_CHECKING

import msgspec

from autograder import course
from autograder.messages.workspaces import Source
from autograder.temporary_folders import HeldFolder
from autograder.workspaces.builds.builds import BuildTookTooLong
from autograder.workspaces.builds.colcon import look
from autograder.workspaces.builds.interface_packages import holds_only_interfaces, simplified
from autograder.workspaces.graded_builds import GradedBuilds
from autograder.workspaces.preparation import COURSE
from autograder.workspaces.program_plans import reference_workspace
from autograder.workspaces.sources import Tree

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from autograder.workspaces.builds.colcon import Build
    from autograder.workspaces.running.jobs import Jobs

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
        folder: The folder for these builds; see :func:`autograder.workspaces.builds.cache.graders_root`.
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
