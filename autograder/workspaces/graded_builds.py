"""A build that a grade may rest on: made in a box of its own from the sources alone, taken over as data.

It may be used again for the same sources, whoever hands them in. No box can write to the cache.

Packages that hold interfaces and nothing else are often the same but for comments and spaces. Of the second one with
the same meaning a normalised copy without comments is built, so that equal definitions are built once.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from autograder.workspaces import artefacts, cache
from autograder.workspaces.builds import Builds, state
from autograder.workspaces.colcon import failed
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
        room: Bytes that all builds used here may take, whoever made them.
    """

    def __init__(self, folder: Path, jobs: Jobs, room: int = ROOM) -> None:
        super().__init__(folder, jobs, room)
        self._paid: set[str] = set()

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
            if cache.is_complete(one.key, self._folder):  # else it may just be made, and is not waited for
                return self._entry(found, one)
        met = self._folder / f"{shared.key}.met"
        if met.exists() and (made := self._entry(found, shared)).ok:
            return made
        made = self._entry(found, order)
        if made.ok:
            met.touch()
        return made

    def _entry(self, found: Build, order: BuildOrder) -> Build:
        """The build, where there is room for it: who finds it made needs as much as who had it made."""
        made = super()._entry(found, order)
        if made.install is None or order.key in self._paid:
            return made
        try:
            artefacts.check_room(size := cache.size_of(made.install), self._room)
        except artefacts.BadArtefacts as error:
            return failed(found, f"error: {error}")
        self._room -= size
        self._paid.add(order.key)
        return made


def _hidden_from(packages: Sequence[Package]) -> Sequence[Path]:
    """The course's own interfaces, from a build that makes some."""
    return course_interfaces() if any(package.interface_files for package in packages) else ()
