"""From a path to a program, here or in a box: look, build what is needed, report, and say what is to be run."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING

from autograder.workspaces.building.colcon import look
from autograder.workspaces.running.plans import lacks_programs, launch_targets, reference_workspace
from autograder.workspaces.running.prefixes import relocated, with_prefixes
from autograder.workspaces.running.reporting import built_line, found_line
from autograder.workspaces.sources.finding import WORKSPACE

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from autograder.workspaces.building.colcon import Build, Targets
    from autograder.workspaces.running.plans import Plan

COURSE = "course_ws"
"""The place of the course's own packages, behind the student's."""


@dataclass(frozen=True)
class Prepared:
    """A program that can be started.

    Attributes:
        command: The command.
        environment: Its whole environment, in which the builds are found.
        builds: What it may read, by the names of the places.
    """

    command: Sequence[str]
    environment: Mapping[str, str]
    builds: Mapping[str, Build]


class Preparation(ABC):
    """Prepares what an exercise runs of a workspace or a launch file, and reports on the way.

    Args:
        environment: The environment of programs, before anything is added to it.
    """

    def __init__(self, environment: Mapping[str, str]) -> None:
        self._environment = environment

    @abstractmethod
    def build(self, found: Build, targets: Targets | None, name: str) -> Build:
        """See :meth:`autograder.workspaces.building.builds.Builds.build`."""

    @abstractmethod
    def report(self, line: str) -> None:
        """Say a line of the report that a check reads."""

    def built(self, line: str) -> None:
        """Say the line about a build that has ended."""
        self.report(line)

    def place(self, name: str, entry: Path) -> Path:
        """The path at which the program sees a folder of the cache: its own, unless there is a box.

        Args:
            name: See :meth:`autograder.workspaces.jobs.Builder.place`.
            entry: The folder.
        """
        del name
        return entry

    def workspace(self, plan: Plan, folder: Path) -> Prepared | None:
        """Prepare what an exercise runs of a workspace.

        Returns:
            None where there is nothing to run; the report says why.
        """
        found = look(folder)
        self.report(found_line(found, plan))
        made = found if found.trouble else self.build(found, plan.targets, WORKSPACE)
        missing = plan.missing(made) if made.ok else ""
        self.built(built_line(made, plan, missing))
        if not made.ok or missing:
            return None
        return Prepared(plan.command(made), self._with(self._environment, WORKSPACE, made), {WORKSPACE: made})

    def launch(self, command: Sequence[str], file: Path | None, workspace: Path | None) -> Prepared | None:
        """Prepare a launch with the student's packages and, after these, the course's own ``my_robot_pkg``.

        Args:
            command: The launch command.
            file: The launch file, where it is known.
            workspace: The workspace that the file belongs to: of that is built what the file needs.

        Returns:
            None where the student's packages could not be built.
        """
        builds: dict[str, Build] = {}
        environment, course_first = self._environment, False
        # What students are handed has no programs but theirs: those would be Lab 1.2's solutions.
        if (own := reference_workspace()).is_dir():
            builds[COURSE] = self.build(look(own), None, COURSE)
        if file is not None and workspace is not None:
            made = self.build(look(workspace), launch_targets(file), WORKSPACE)
            self.built(built_line(made))
            if not made.ok:
                return None
            course_first = COURSE in builds and lacks_programs(file, made, builds[COURSE])
            environment = self._with(environment, WORKSPACE, made)
            builds[WORKSPACE] = made
        if COURSE in builds:
            environment = self._with(environment, COURSE, builds[COURSE], last=not course_first)
        return Prepared(command, environment, builds)

    def _with(
        self, environment: Mapping[str, str], name: str, made: Build, *, last: bool = False
    ) -> Mapping[str, str]:
        """An environment in which a build is found, by somebody who sees it at its place."""
        found = with_prefixes(environment, made.prefixes, last=last)
        if made.install is None:
            return found
        entry = made.install.parent
        return relocated(found, entry, self.place(name, entry))
