"""Mistakes in a workspace, recognized from the report of its build."""

from __future__ import annotations

from typing import TYPE_CHECKING

import re2

from autograder.kit.model import Advice, Mistake, mistake
from autograder.kit.workspace_report import WorkspaceReport, report_of

if TYPE_CHECKING:
    from autograder.kit.evidence import Evidence, Part


def build_report(part: Part) -> WorkspaceReport | None:
    """Return the report made after the build; if there is none, the report made before the build."""
    return report_of(part) or report_of(part, "found")


def seen_of_build(report: WorkspaceReport) -> str:
    """Return the outcome of a build in a few words for the card."""
    if report.trouble in ("build", "entry_point"):
        return f"colcon could not build {report.package or 'it'}: {report.line}"
    return report.line or report.trouble.replace("_", " ")


def changed_since_build(evidence: Evidence) -> str:
    """Return a remark for the card if sources have changed since the student's last `colcon build`; else empty."""
    report = build_report(evidence.main)
    if report is None or not report.changed:
        return ""
    return (
        f"Changed since the last `colcon build`: {report.changed}. This check has built the sources as they are now, "
        "but `ros2 run` starts the older build until you run `colcon build` again."
    )


def _trouble(evidence: Evidence, *kinds: str) -> WorkspaceReport | None:
    """Return the report of the build if its trouble is one of the given kinds; otherwise None."""
    report = build_report(evidence.main)
    return report if report is not None and report.trouble in kinds else None


def _build_failed(evidence: Evidence) -> Advice | None:
    report = _trouble(evidence, "build")
    if report is None:
        return None
    if re2.search(r"rosidl_generate_interfaces\(\) the passed file '[^']*' doesn't exist", report.line):
        next_step = (
            'Write the path relative to the folder of the package, such as "srv/Name.srv". Check capital letters, '
            "too."
        )
    elif re2.search(r":\d+: ", report.line):
        next_step = (
            "Go to the file and line in this message. `colcon build` in the workspace shows the whole log."
        )
    else:
        next_step = (
            "Run `colcon build` in the workspace to see the whole log, and look for the first line with the word "
            "error."
        )
    return Advice(f"colcon build fails in {report.package or 'the workspace'}: {report.line}", next_step)


def _unreadable(evidence: Evidence) -> tuple[str, WorkspaceReport] | None:
    """Return the file that Python could not parse during the build, and the report; None if there is no such file."""
    report = _trouble(evidence, "build")
    if report is None or not re2.search(r"(?:Syntax|Indentation|Tab)Error", report.line):
        return None
    return report.line.partition(": ")[0], report


BUILD = (
    mistake(
        "no_workspace",
        lambda evidence: _trouble(evidence, "no_workspace", "no_package"),
        "There is nothing to build: {0.line}.",
        "A workspace is a folder that contains a folder `src`. Make each package inside `src`, with `ros2 pkg create`.",
        certain=True,
    ),
    mistake(
        "bad_package",
        lambda evidence: _trouble(evidence, "bad_package"),
        "A package cannot be built: {0.line}.",
        "Correct package.xml. colcon does not report that this file is not valid, and builds the package as another "
        "type.",
        certain=True,
    ),
    mistake(
        "syntax_error",
        _unreadable,
        "Python could not read {0[0]} when it built {0[1].package}: {0[1].line}",
        "In this line or just before it, a bracket, a quotation mark, a colon or the indentation is wrong.",
        certain=True,
    ),
    mistake(
        "entry_point",
        lambda evidence: _trouble(evidence, "entry_point"),
        "colcon build fails in {0.package}: setup.py has an entry point of the wrong form.",
        "{0.line}",
        certain=True,
    ),
    Mistake("build_failed", _build_failed, certain=True),
)
"""Mistakes that keep a workspace from being built."""
