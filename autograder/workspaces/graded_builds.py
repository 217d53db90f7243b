"""Makes the builds on which a grade depends: in a box, from the sources alone.

No submission shares a build with another submission, or with a second execution of itself. Otherwise the duration of a
build would reveal to a notebook what classmates have handed in, or that it runs for the second time. The only
exceptions are packages that the course itself publishes or makes, which are built in advance, once for all submissions
(:mod:`autograder.workspaces.built_ahead`). No submission can change such a build, because no box can write to the
folders with builds.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from autograder.workspaces.builds import artefacts, cache
from autograder.workspaces.builds.builds import Builds, state
from autograder.workspaces.builds.colcon import failed
from autograder.workspaces.builds.interface_packages import holds_only_interfaces, simplified
from autograder.workspaces.program_plans import course_interfaces

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from autograder.workspaces.builds.colcon import Build
    from autograder.workspaces.packages import Package
    from autograder.workspaces.running.jobs import BuildOrder, Jobs

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
            if self._ahead and cache.is_complete(one.key, self._ahead):
                return self._entry(found, one, self._ahead)
        return self._entry(found, order)

    def _entry(self, found: Build, order: BuildOrder, folder: Path | None = None) -> Build:
        """Return the build, or a failed build if all builds, including those made in advance, exceed the size limit."""
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
    """Return the files to hide from a build: the course's own interfaces, if the packages define interfaces."""
    return course_interfaces() if any(package.interface_files for package in packages) else ()
