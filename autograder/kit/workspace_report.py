"""The report about a workspace: one line of JSON after a mark, among a program's other output.

The judge sees a workspace's programs on the wire. The program that builds the workspace reports what is not visible
there (such as the line at which the build failed), before the student's own program prints anything: only the first
report counts. A line holds less than a workspace. So the packages that the exercise needs come first, and a report
tells whether it contains all of them: what was left out is never judged as missing or wrong.
"""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, field, replace
from typing import TYPE_CHECKING

from autograder.kit.evidence import REPORTS, Part

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from autograder.kit.evidence import Event

MARK = REPORTS[0]
MAX_LINE = 3_900
"""The limit on a report in bytes: the judge reads lines of at most 4,000."""
_LIMITS = (2_500, 1_200, 600, 200, 50)
"""The limits on each text of a report in characters, tried in turn until its line is short enough."""
AMENT_PACKAGE = "ament_package()"
"""The missing thing in the report on a package that was built but that ROS does not find."""
BUILDING = 180.0
"""Seconds of wall time that a build may take: a Python package needs one, an interface package ten."""
_FEW = 10
"""The number of other packages that are named if there is no space for all."""


@dataclass(frozen=True)
class Interface:
    """An interface file of a package.

    Attributes:
        file: The path inside the package, such as ``"srv/AddTwoInts.srv"``.
        text: The content without comments; None if the exercise is not about it, or if it was left out.
        listed: Whether the package's CMakeLists.txt names it, or is too long to be looked into.
    """

    file: str
    text: str | None
    listed: bool


@dataclass(frozen=True)
class PackageReport:
    """A package of the workspace as its files describe it.

    Attributes:
        name: The name in its package.xml.
        build_type: ``"ament_python"`` or ``"ament_cmake"``.
        programs: Its console scripts, as ``name = module:function``: the installed ones, or before the build those
            that can be read in setup.py.
        interfaces: Its interface files.
        dependencies: All dependencies in package.xml, including ``member_of_group``.
        modules: Its Python files, as paths inside the package.
        commented: What package.xml would depend on, too, if the lines inside its comments counted.
        installed: The programs that `ros2 run` finds of it, by name; empty before the build.
        launch_files: Its launch files, as paths inside the package; after the build those that are installed, as paths
            below the folder of the package in ``install``.
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
    """The outcome of a build.

    Attributes:
        phase: ``"found"`` before the build, ``"built"`` after it.
        built: True if every package was built.
        trouble: The kind of trouble: ``"no_workspace"``, ``"no_package"``, ``"bad_package"``, ``"entry_point"``,
            ``"build"`` or empty.
        package: The package that failed; empty if none did.
        line: The most telling line of a failure.
        log: The end of the log of a failure.
        packages: The packages of the workspace, those that the exercise needs first.
        missing: Of what the exercise asks for (a program, an interface), what is not there after the build.
        complete: Whether nothing of the packages that the exercise needs was left out.
        changed: The sources, in words, that the student has changed since the last `colcon build`; empty in a class.
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


def as_line(report: WorkspaceReport, others: Sequence[PackageReport] = ()) -> str:
    """Return the line of the report; what does not fit is left out.

    Args:
        report: A report on the packages that the exercise needs.
        others: The other packages of the workspace: in full, by name or not at all, depending on the space.
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
    """Return a package without its longer definitions and the ends of its lists; unchanged if all of it is short."""
    few = limit // 20
    return replace(
        package,
        programs=package.programs[:few],
        interfaces=[_left_out(i) if len(i.text or "") > limit else i for i in package.interfaces[:few]],
        # Dependencies that a task may require come first: those that generate interfaces.
        dependencies=sorted(package.dependencies, key=lambda name: not name.startswith("rosidl_"))[
            : max(few, 5)
        ],
        modules=package.modules[: limit // 60],  # none where all else needs the room
        commented=package.commented[: limit // 60],
        installed=package.installed[:few],
        launch_files=package.launch_files[: max(few, 5)],
    )


def _left_out(interface: Interface) -> Interface:
    return replace(interface, text=None)


def _written(report: WorkspaceReport) -> str:
    line = MARK + json.dumps(asdict(report), ensure_ascii=False, separators=(",", ":"))
    # The name of a file that is not UTF-8 has lone surrogates in Python, which cannot be printed.
    return line.encode(errors="replace").decode()


def report_of(part: Part, phase: str = "built") -> WorkspaceReport | None:
    """Return the first report of a phase; None if there is none, for example if a command built nothing."""
    return next((report for _, report in _reports(part) if report.phase == phase), None)


def tells_of_a_build(line: str) -> bool:
    """True if a line of output is the report of a finished build."""
    report = _parsed(line.removeprefix(MARK)) if line.startswith(MARK) else None
    return report is not None and report.phase == "built"


def build_ended(part: Part) -> float:
    """Return the time in a part at which the workspace was built, in seconds; 0 if nothing was built."""
    return next((event.t for event, report in _reports(part) if report.phase == "built"), 0.0)


def _reports(part: Part) -> Iterator[tuple[Event, WorkspaceReport]]:
    for event in part.of("output"):
        text = str(event.data["text"])
        if text.startswith(MARK) and (report := _parsed(text[len(MARK) :])):
            yield event, report


def _parsed(text: str) -> WorkspaceReport | None:
    try:
        data = json.loads(text)
        packages = [
            PackageReport(**{**package, "interfaces": [Interface(**i) for i in package.pop("interfaces")]})
            for package in data.pop("packages")
        ]
        return WorkspaceReport(**data, packages=packages)
    except (ValueError, TypeError, KeyError, AttributeError, RecursionError):
        return None
