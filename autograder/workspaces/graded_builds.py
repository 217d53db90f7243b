"""Builds that a grade may rest on: made in a box of their own from the sources alone, taken over as data.

A submission shares no build with any other, nor with itself when it is executed again: otherwise the time that a build
takes would tell a notebook what classmates have handed in, or that it runs for the second time. Only what the course
itself publishes or makes is built ahead, once for all (:mod:`autograder.workspaces.built_ahead`). No box can write to
either folder.
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
    """Builds that one execution of a submission needs.

    Packages that hold interfaces and nothing else are often the same but for comments and spaces: of these, a build
    ahead is found if it means the same.

    Args:
        folder: The builds of this execution. It belongs to the grader alone.
        jobs: Run colcon, and what was built.
        ahead: The folder of what was built ahead; None where nothing is shared.
        room: Bytes that all builds used here may take, whoever made them.
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
            if self._ahead and cache.is_complete(one.key, self._ahead):
                return self._entry(found, one, self._ahead)
        return self._entry(found, order)

    def _entry(self, found: Build, order: BuildOrder, folder: Path | None = None) -> Build:
        """The build, where there is room for it: who finds it made needs as much as who had it made."""
        made = super()._entry(found, order, folder)
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
