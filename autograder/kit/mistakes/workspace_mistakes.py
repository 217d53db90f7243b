"""Mistakes in a workspace, recognized from the report of the build and from messages of ``ros2``."""

from __future__ import annotations

from typing import TYPE_CHECKING

import re2

from autograder.kit.model import Advice, Mistake, mistake
from autograder.kit.workspace_report import WorkspaceReport, report_of

if TYPE_CHECKING:
    from autograder.kit.evidence import Evidence, Part


def build_report(part: Part) -> WorkspaceReport | None:
    """Return the report made after the build; if there is none, the one made before the build."""
    return report_of(part) or report_of(part, "found")


def seen_of_build(report: WorkspaceReport) -> str:
    """Return the outcome of a build, in a few words for the card."""
    if report.trouble in ("build", "entry_point"):
        return f"colcon could not build {report.package or 'it'}: {report.line}"
    return report.line or report.trouble.replace("_", " ")


def changed_since_build(evidence: Evidence) -> str:
    """Return the card's remark if the student has changed sources since the last `colcon build`; else an empty text."""
    report = build_report(evidence.main)
    if report is None or not report.changed:
        return ""
    return (
        f"Changed since the last `colcon build`: {report.changed}. This check has built the sources as they are now; "
        "`ros2 run` starts the older build until you run `colcon build` again."
    )


def _trouble(evidence: Evidence, *kinds: str) -> WorkspaceReport | None:
    """Return the report of the build if its trouble is one of these kinds; else None."""
    report = build_report(evidence.main)
    return report if report is not None and report.trouble in kinds else None


def _build_failed(evidence: Evidence) -> Advice | None:
    report = _trouble(evidence, "build")
    if report is None:
        return None
    if re2.search(r"rosidl_generate_interfaces\(\) the passed file '[^']*' doesn't exist", report.line):
        next_step = (
            "Write the path as it is seen from the folder of the package, with the folder that the file is in, such as "
            '"srv/Name.srv"; capitals count.'
        )
    elif re2.search(r":\d+: ", report.line):
        next_step = (
            "Go to the place that the line names. `colcon build` in the workspace shows the whole log."
        )
    else:
        next_step = "`colcon build` in the workspace shows the whole log: look for the first line with the word error."
    return Advice(f"colcon build fails in {report.package or 'the workspace'}: {report.line}", next_step)


def _unreadable(evidence: Evidence) -> tuple[str, WorkspaceReport] | None:
    """Return the file that Python could not parse during the build, with the report; None if there is none."""
    report = _trouble(evidence, "build")
    if report is None or not re2.search(r"(?:Syntax|Indentation|Tab)Error", report.line):
        return None
    return report.line.partition(": ")[0], report


BUILD = (
    mistake(
        "no_workspace",
        lambda evidence: _trouble(evidence, "no_workspace", "no_package"),
        "There is nothing to build: {0.line}.",
        "A workspace is a folder with src in it, and each package is a folder in src, made there with "
        "`ros2 pkg create`.",
        certain=True,
    ),
    mistake(
        "bad_package",
        lambda evidence: _trouble(evidence, "bad_package"),
        "A package cannot be used: {0.line}.",
        "Correct package.xml. colcon does not say that it is not valid, and treats the package as another kind.",
        certain=True,
    ),
    mistake(
        "syntax_error",
        _unreadable,
        "Python could not read {0[0]} when {0[1].package} was built: {0[1].line}",
        "A bracket, a quote, a colon or the indentation is off there or just before it.",
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
"""The mistake that ROS, in a command's environment, does not know the package."""
