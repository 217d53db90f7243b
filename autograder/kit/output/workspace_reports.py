"""Reports on a workspace and its build: one line of JSON each, which a runner prints and exercises read.

The judge observes the subject's programs on the network. The reports add facts that are not visible there, such as the
line at which the build failed.

A student's program cannot forge the report on the build, because the true one is printed before the program prints
anything, and only the first report counts. One line may be too short for a large workspace. So the packages that the
exercise needs come first, and the report says whether all their details fit: a package that was left out never counts
as missing or wrong.
"""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, field, replace
from typing import TYPE_CHECKING

from autograder.kit.output.spoken_lines import REPORTS

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from autograder.kit.evidence import Event, Part


WORKSPACE_MARK = REPORTS[0]
"""The beginning of a line that reports on a workspace."""
MAX_LINE = 3_900
"""The maximum length of a report in bytes; the judge reads lines of at most 4,000."""
_LIMITS = (2_500, 1_200, 600, 200, 50)
"""Maximum lengths, in characters, of each text in a report. They are tried in turn until the line is short enough."""
AMENT_PACKAGE = "ament_package()"
"""The value of ``missing`` if a package was built but ROS does not find it, because its CMakeLists.txt lacks this call.
"""
_FEW = 10
"""The number of other packages that the report names if not all of their names fit."""


@dataclass(frozen=True)
class Interface:
    """A file of a package that defines a message, a service or an action.

    Attributes:
        file: The path of the file inside the package, such as ``"srv/AddTwoInts.srv"``.
        text: The content without comments; None if the exercise does not need it, or if it did not fit.
        listed: True if the package's CMakeLists.txt names the file; also True if CMakeLists.txt is too long to be
            searched.
    """

    file: str
    text: str | None
    listed: bool


@dataclass(frozen=True)
class PackageReport:
    """A package of the workspace, described by its files.

    Attributes:
        name: The package's name in its package.xml.
        build_type: ``"ament_python"`` or ``"ament_cmake"``.
        programs: The package's console scripts, as ``name = module:function``: before the build those in setup.py,
            after the build the installed ones.
        interfaces: The interface files of the package.
        dependencies: All dependencies in package.xml, including ``member_of_group``.
        modules: The package's Python files, as paths inside the package.
        commented: The dependencies inside comments of package.xml, which do not count.
        installed: The names of the package's programs that `ros2 run` finds; empty before the build.
        launch_files: The package's launch files, as paths inside the package; after the build, the installed files, as
            paths inside the package's folder in ``install``.
    """

    name: str
    build_type: str
    programs: Sequence[str] = ()
    interfaces: Sequence[Interface] = ()
    dependencies: Sequence[str] = ()
    modules: Sequence[str] = ()
    commented: Sequence[str] = ()
    installed: Sequence[str] = ()
    launch_files: Sequence[str] = ()


@dataclass(frozen=True)
class WorkspaceReport:
    """The state of a workspace before its build, or the outcome of the build.

    Attributes:
        phase: ``"found"`` before the build, ``"built"`` after it; ``"failed"`` if the runner itself failed before it
            started the student's program.
        built: True if every package was built.
        trouble: The kind of failure: ``"no_workspace"``, ``"no_package"``, ``"bad_package"``, ``"entry_point"`` or
            ``"build"``; empty if there is none.
        package: The name of the package that failed; empty if none did.
        line: The line of the log that explains the failure best.
        log: The end of the log of the failed build.
        packages: The packages of the workspace. Those that the exercise needs come first.
        missing: The programs and interfaces that the exercise needs but the build did not produce.
        complete: True if the report contains all details of the packages that the exercise needs.
        changed: The sources that the student has changed since the last `colcon build`, in words; empty when grading
            a class.
    """

    phase: str
    built: bool
    trouble: str = ""
    package: str = ""
    line: str = ""
    log: str = ""
    packages: Sequence[PackageReport] = field(default=())
    missing: str = ""
    complete: bool = True
    changed: str = ""


def workspace_report_line(report: WorkspaceReport, others: Sequence[PackageReport] = ()) -> str:
    """Return the report as one line. Details that do not fit are left out.

    Args:
        report: A report on the packages that the exercise needs.
        others: The other packages of the workspace. If they fit, they are reported with all details; otherwise only
            their names, or nothing.
    """
    whole = _written(report)
    named = [PackageReport(package.name, package.build_type) for package in others]
    for limit in _LIMITS:
        needed = [_shortened(package, limit) for package in report.packages]
        cut = replace(
            report,
            log=report.log[-limit:],
            line=report.line[:limit],
            changed=report.changed[:limit],
            complete=report.complete and _written(replace(report, packages=needed)) == whole,
        )
        for beside in (others, named, named[:_FEW], ()):
            line = _written(replace(cut, packages=[*needed, *beside]))
            if len(line.encode()) <= MAX_LINE:
                return line
    return _written(replace(cut, packages=[], complete=False))


def _shortened(package: PackageReport, limit: int) -> PackageReport:
    """Return a package with shorter lists and without long definitions; unchanged if everything is short."""
    few = limit // 20
    return replace(
        package,
        programs=package.programs[:few],
        interfaces=[
            replace(i, text=None) if len(i.text or "") > limit else i for i in package.interfaces[:few]
        ],
        # Dependencies whose names begin with rosidl_ come first, because a task may require them.
        dependencies=sorted(package.dependencies, key=lambda name: not name.startswith("rosidl_"))[
            : max(few, 5)
        ],
        # For the smallest limit, these two lists are empty, because other fields need the space.
        modules=package.modules[: limit // 60],
        commented=package.commented[: limit // 60],
        installed=package.installed[:few],
        launch_files=package.launch_files[: max(few, 5)],
    )


def _written(report: WorkspaceReport) -> str:
    line = WORKSPACE_MARK + json.dumps(asdict(report), ensure_ascii=False, separators=(",", ":"))
    # A file name that is not UTF-8 contains lone surrogates in Python, which cannot be printed.
    return line.encode(errors="replace").decode()


def report_of(part: Part, phase: str = "built") -> WorkspaceReport | None:
    """Return the first report of a phase; None if there is none, for example because the subject is not a workspace."""
    return next((report for _, report in _reports(part) if report.phase == phase), None)


def failed_line(error: Exception) -> str:
    """Return the line of the report about a runner that itself failed."""
    return workspace_report_line(
        WorkspaceReport("failed", built=False, line=f"{type(error).__name__}: {error}")
    )


def runner_trouble(parts: Sequence[Part]) -> str:
    """Return why a runner itself failed; empty if none did. A program cannot say so: a build was reported before it."""
    reports = (report_of(part, "failed") for part in parts if report_of(part) is None)
    return next((report.line for report in reports if report is not None), "")


def tells_of_a_build(line: str) -> bool:
    """Return True if a line of output is the report of a finished build."""
    report = _parsed_report(line.removeprefix(WORKSPACE_MARK)) if line.startswith(WORKSPACE_MARK) else None
    return report is not None and report.phase == "built"


def build_ended(part: Part) -> float:
    """Return the time at which the workspace was built, in seconds since the part began; 0 if nothing was built."""
    return next((event.t for event, report in _reports(part) if report.phase == "built"), 0.0)


def _reports(part: Part) -> Iterator[tuple[Event, WorkspaceReport]]:
    for event in part.of("output"):
        text = str(event.data["text"])
        if text.startswith(WORKSPACE_MARK) and (report := _parsed_report(text[len(WORKSPACE_MARK) :])):
            yield event, report


def _parsed_report(text: str) -> WorkspaceReport | None:
    try:
        data = json.loads(text)
        packages = [
            PackageReport(**{**package, "interfaces": [Interface(**i) for i in package.pop("interfaces")]})
            for package in data.pop("packages")
        ]
        return WorkspaceReport(**data, packages=packages)
    except (ValueError, TypeError, KeyError, AttributeError, RecursionError):
        return None
