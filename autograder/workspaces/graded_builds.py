"""A build that a grade may rest on: made in a box of its own from the sources alone, taken over as data.

It may be used again for the same sources, whoever hands them in. No box can write to the cache.

Packages that hold interfaces and nothing else are often the same but for comments and spaces. Of the second one with
the same meaning a normalised copy without comments is built, so that equal definitions are built once.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from autograder.workspaces import cache
from autograder.workspaces.builds import Builds, state
from autograder.workspaces.interface_packages import holds_only_interfaces, simplified
from autograder.workspaces.plans import course_interfaces

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from autograder.workspaces.colcon import Build
    from autograder.workspaces.jobs import BuildOrder, Jobs
    from autograder.workspaces.packages import Package

ROOM = 32_000_000
"""Bytes for all builds of one notebook together; an interface package takes two million, a Python package 300,000."""


class GradedBuilds(Builds):
    """Builds that one submission's workspaces need, from the cache or made.

    Args:
        folder: The cache. It belongs to the grader alone.
        jobs: Run colcon, and what was built.
        room: Bytes that all builds made here may add to the cache.
    """

    def __init__(self, folder: Path, jobs: Jobs, room: int = ROOM) -> None:
        super().__init__(folder, jobs, room)

    def _find_or_make(self, found: Build, chosen: Sequence[Package], order: BuildOrder) -> Build:
        hidden = _hidden_from(chosen)
        others = [f"{path} {state(str(path))}" for path in course_interfaces() if path not in hidden]
        order = self._keyed(replace(order, hidden=hidden), *others)
        if not all(map(holds_only_interfaces, chosen)):
            return self._entry(found, order)
        return self._shared(found, order, self._keyed(replace(order, tree=simplified(order.tree)), *others))

    def _shared(self, found: Build, order: BuildOrder, shared: BuildOrder) -> Build:
        """The build itself, or one that means the same, in nobody's words."""
        for one in (order, shared):
            if (made := self._kept(found, one.key)) is not None:
                return made
        met = self._folder / f"{shared.key}.met"
        if met.exists() and (made := self._entry(found, shared)).ok:
            return made
        made = self._entry(found, order)
        if made.ok:
            met.touch()
        return made

    def _kept(self, found: Build, key: str) -> Build | None:
        """The build that is there already; None where it is not, or is just being made."""
        if not cache.is_complete(key, self._folder):
            return None
        with cache.entry(key, self._folder) as entry:
            if not entry.complete:
                return None
            return replace(found, ok=True, install=entry.folder / "install", reused=True)


def _hidden_from(packages: Sequence[Package]) -> Sequence[Path]:
    """The course's own interfaces, from a build that makes some."""
    return course_interfaces() if any(package.interface_files for package in packages) else ()
