"""Describes a workspace and its build in the report that a check reads."""

from __future__ import annotations

from typing import TYPE_CHECKING

import re2

from autograder.kit.workspace_report import Interface, PackageReport, WorkspaceReport, as_line
from autograder.workspaces.byte_budget import ByteBudget
from autograder.workspaces.packages import MAX_LOOK, launch_files

if TYPE_CHECKING:
    from pathlib import Path

    from autograder.workspaces.builds.colcon import Build
    from autograder.workspaces.packages import Package
    from autograder.workspaces.program_plans import Plan

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
    packages = [_described(p, definition, made, budget) for p in made.packages if p.name in needed]
    complete = budget.sufficed
    others = [_described(p, definition, made, budget) for p in made.packages if p.name not in needed]
    return as_line(
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
    return as_line(WorkspaceReport("built", built=False, trouble="no_workspace", line=trouble))


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
    listed = package.cmake_lists is None or file.name in package.cmake_lists
    if file.name != definition or not budget.has(package.folder / file):
        return Interface(file.as_posix(), None, listed)
    text = (package.folder / file).read_text(encoding="utf-8", errors="replace")
    return Interface(file.as_posix(), _without_comments(text), listed)


def _without_comments(text: str) -> str:
    """Return an interface definition without comments and empty lines. A # inside quotes does not begin a comment."""
    lines = (
        line if re2.search(r"^[^#]*['\"]", line) else line.partition("#")[0] for line in text.splitlines()
    )
    return "\n".join(line.strip() for line in lines if line.strip())
