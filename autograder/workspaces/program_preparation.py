"""Prepares the program that a check runs: checks the workspace, builds the needed packages, and reports the results.

The report describes the workspace and its build. The check reads the report before the output of the program.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import re2

from autograder.course import NoCourse
from autograder.kit.output.workspace_reports import (
    Interface,
    PackageReport,
    WorkspaceReport,
    workspace_report_line,
)
from autograder.workspaces.builds.colcon_build import describe_workspace
from autograder.workspaces.builds.install_folder import relocated, with_prefixes
from autograder.workspaces.packages import MAX_LOOK, WORKSPACE, launch_files
from autograder.workspaces.program_plans import lacks_programs, launch_targets, reference_workspace
from autograder.workspaces.sources import ByteBudget

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from pathlib import Path

    from autograder.workspaces.builds.cached_builds import Builds
    from autograder.workspaces.builds.colcon_build import Build, Targets
    from autograder.workspaces.packages import Package
    from autograder.workspaces.program_plans import Plan


COURSE = "course_ws"
"""The name under which jobs see the course's own packages. The student's packages take precedence over them."""
_ALL_OUTPUT = {"OVERRIDE_LAUNCH_PROCESS_OUTPUT": "both"}
"""An environment variable that makes a launch show a node's output, whatever its launch file says
(launch/actions/execute_local.py, ``output``).
"""


@dataclass(frozen=True)
class Prepared:
    """A program that is ready to start.

    Attributes:
        command: The command.
        environment: All environment variables of the program, including those with which ROS finds the builds.
        builds: The builds that the program may read, by kind of workspace (:data:`WORKSPACE`, :data:`COURSE`).
    """

    command: Sequence[str]
    environment: Mapping[str, str]
    builds: Mapping[str, Build]


@dataclass(frozen=True)
class Preparation:
    """Prepares the program that an exercise runs from a workspace or a launch file, and reports on the way.

    Attributes:
        builds: Finds or makes the builds. Its ``jobs`` also run the program.
        report: Called with each line of the report for the check.
        build_ended: Called when a build has ended, before its result is reported.
        cancelled: Returns True when the program is no longer needed.
    """

    builds: Builds
    report: Callable[[str], None]
    build_ended: Callable[[], None] = lambda: None
    cancelled: Callable[[], bool] = lambda: False

    def workspace(self, plan: Plan, folder: Path) -> Prepared | None:
        """Prepare the program that an exercise runs from a workspace.

        Returns:
            The program; None if there is nothing to run, for the reason that the report contains.
        """
        found = describe_workspace(folder)
        self.report(report_line("found", found, plan))
        made = found if found.trouble else self._built(found, plan.targets)
        missing = plan.missing(made) if made.ok else ""
        self.build_ended()
        self.report(report_line("built", made, plan, missing))
        if not made.ok or missing:
            return None
        command = plan.command(made)
        if (file := plan.launches(made)) is not None:
            return self._launched(command, file, made, self._course())
        return Prepared(command, self._with(self.builds.jobs.environment, WORKSPACE, made), {WORKSPACE: made})

    def launch(self, command: Sequence[str], file: Path | None, workspace: Path | None) -> Prepared | None:
        """Prepare a launch in which ROS finds the student's packages first, then the course's own ``my_robot_pkg``.

        Args:
            command: The launch command.
            file: The launch file, if it is known.
            workspace: The workspace of the launch file. The packages that the file needs are built.

        Returns:
            The program; None if the student's packages could not be built.

        Raises:
            RuntimeError: The course's own package could not be built.
        """
        course = self._course()
        if file is None or workspace is None:
            return self._launched(command, file, None, course)
        made = self._built(describe_workspace(workspace), launch_targets(file))
        self.build_ended()
        self.report(report_line("built", made))
        return self._launched(command, file, made, course) if made.ok else None

    def _course(self) -> Build | None:
        """Return the build of the course's own packages; None in a student's copy of the course, also in a box.

        A student's copy does not contain these packages, because they are the solutions of Lab 1.2.
        """
        try:
            own = reference_workspace()
        except NoCourse:
            return None
        if not own.is_dir():
            return None
        course = self.builds.build(describe_workspace(own), None, name=COURSE)
        if not course.ok:
            raise RuntimeError(f"the course's own packages could not be built: {course.line}")
        return course

    def _launched(
        self, command: Sequence[str], file: Path | None, made: Build | None, course: Build | None
    ) -> Prepared:
        """Return a launch that finds the student's build first, then the course's build.

        But if the student's package lacks programs of the course's package, a copy of the course's build with the
        student's files added comes first.
        """
        environment: Mapping[str, str] = {**self.builds.jobs.environment, **_ALL_OUTPUT}
        builds: dict[str, Build] = {}
        if made is not None:
            builds[WORKSPACE] = made
            environment = self._with(environment, WORKSPACE, made)
        if course is not None:
            lent = made is not None and file is not None and lacks_programs(file, made, course)
            builds[COURSE] = self.builds.lend(made, course) if made is not None and lent else course
            environment = self._with(environment, COURSE, builds[COURSE], last=not lent)
        return Prepared(command, environment, builds)

    def _built(self, found: Build, targets: Targets) -> Build:
        return self.builds.build(found, targets, cancelled=self.cancelled)

    def _with(
        self, environment: Mapping[str, str], name: str, made: Build, *, last: bool = False
    ) -> Mapping[str, str]:
        """Return the environment with a build's folders added, by the paths at which a job sees them."""
        found = with_prefixes(environment, made.prefixes, last=last)
        if made.install is None:
            return found
        entry = made.install.parent
        return relocated(found, entry, self.builds.jobs.place(name, entry))


MAX_LOG = 3_000
"""The maximum number of characters to report from the end of a build's log."""


def report_line(phase: str, made: Build, plan: Plan | None = None, missing: str = "") -> str:
    """Return the line of the report about a workspace.

    Args:
        phase: ``"found"`` for a report on the sources, before the build; ``"built"`` for one on the result of the
            build.
        made: The description of the workspace, or of its build.
        plan: The exercise's plan for it; None if all packages are equally important.
        missing: The name of a package, program or file that the exercise needs and the workspace lacks.
    """
    needed = set(plan.targets(made)) if plan else set[str]()
    definition = plan.definition if plan else ""
    budget = ByteBudget(MAX_LOOK)
    # The needed packages come first, so that the texts of others cannot use up the budget.
    packages = [_described(p, definition, made, budget) for p in made.packages if p.name in needed]
    complete = budget.sufficed
    others = [_described(p, definition, made, budget) for p in made.packages if p.name not in needed]
    return workspace_report_line(
        WorkspaceReport(
            phase=phase,
            built=made.ok,
            trouble=made.trouble,
            package=made.package,
            line=made.line,
            log=made.log[-MAX_LOG:],
            packages=packages,
            missing=missing,
            complete=complete,
            changed=made.changed,
        ),
        others,
    )


def no_sources_line(trouble: str) -> str:
    """Return the line of the report about a check without usable sources.

    Args:
        trouble: The reason, in words for the student.
    """
    return workspace_report_line(WorkspaceReport("built", built=False, trouble="no_workspace", line=trouble))


def _described(package: Package, definition: str, made: Build, budget: ByteBudget) -> PackageReport:
    files = sorted(package.interface_files, key=lambda file: file.name != definition)
    programs = made.entry_points(package.name, budget)
    if not programs and budget.has(package.folder / "setup.py"):
        programs = package.programs
    launches = made.launch_files(package.name) if made.install else launch_files(package.folder)
    return PackageReport(
        package.name,
        package.build_type,
        programs,
        [_interface(package, file, definition, budget) for file in files],
        package.dependencies,
        tuple(file.as_posix() for file in package.modules),
        package.commented,
        made.programs(package.name),
        tuple(file.as_posix() for file in launches),
    )


def _interface(package: Package, file: Path, definition: str, budget: ByteBudget) -> Interface:
    """Describe an interface file; with its text only if the exercise is about this file (``definition``)."""
    listed = package.cmake_lists is None or file.name in package.cmake_lists
    if file.name != definition or not budget.has(package.folder / file):
        return Interface(file.as_posix(), None, listed)
    text = (package.folder / file).read_text(encoding="utf-8", errors="replace")
    # Leave out comments and empty lines. A # inside quotes does not begin a comment.
    lines = (
        line if re2.search(r"^[^#]*['\"]", line) else line.partition("#")[0] for line in text.splitlines()
    )
    return Interface(file.as_posix(), "\n".join(line.strip() for line in lines if line.strip()), listed)
