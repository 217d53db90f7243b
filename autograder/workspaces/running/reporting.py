"""A workspace and its build, in the words of the report that a check reads."""

from __future__ import annotations

from typing import TYPE_CHECKING

from autograder.kit.workspace_report import Interface, PackageReport, WorkspaceReport, as_line

if TYPE_CHECKING:
    from pathlib import Path

    from autograder.workspaces.building.result import Build
    from autograder.workspaces.sources.packages import Package

MAX_TEXT = 4_000
"""Characters of an interface file that are reported."""
MAX_LOG = 3_000
"""Characters of a build's log that are reported: its end."""


def found_line(found: Build) -> str:
    """What is there, before it is built."""
    return _line(found, "found", "")


def built_line(made: Build, missing: str = "") -> str:
    """What came of a build.

    Args:
        made: The build.
        missing: Of what the exercise asks for, what is not there.
    """
    return _line(made, "built", missing)


def no_sources_line(trouble: str) -> str:
    """The report where there is nothing that could be built.

    Args:
        trouble: Why, for the student.
    """
    return as_line(WorkspaceReport("built", built=False, trouble="no_workspace", line=trouble))


def _line(made: Build, phase: str, missing: str) -> str:
    return as_line(
        WorkspaceReport(
            phase=phase,
            built=made.ok,
            trouble=made.trouble,
            package=made.package,
            line=made.line,
            log=made.log[-MAX_LOG:],
            packages=[_described(package) for package in made.packages],
            missing=missing,
        )
    )


def _described(package: Package) -> PackageReport:
    return PackageReport(
        package.name,
        package.build_type,
        package.programs,
        [_interface(package, file) for file in package.interface_files],
        package.dependencies,
        tuple(file.as_posix() for file in package.modules),
        package.commented,
    )


def _interface(package: Package, file: Path) -> Interface:
    text = (package.folder / file).read_text(encoding="utf-8", errors="replace")[:MAX_TEXT]
    return Interface(file.as_posix(), text, file.name in package.cmake_lists)
