"""What a student's side reports about a workspace: one line of JSON behind a mark, among a program's other output.

The judge sees a workspace's programs on the wire. What no wire can tell (which line the build stumbled over)
is
reported by the program that built it, before the student's own program says anything: only the first report
counts.
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
"""Bytes of a report: the judge reads lines of at most 4,000."""


@dataclass(frozen=True)
class Interface:
    """An interface file of a package.

    Attributes:
        file: Its path inside the package, such as ``"srv/AddTwoInts.srv"``.
        text: Its content.
        listed: Whether the package's CMakeLists.txt names it.
    """

    file: str
    text: str
    listed: bool


@dataclass(frozen=True)
class PackageReport:
    """A package of the workspace as its files describe it.

    Attributes:
        name: The name in its package.xml.
        build_type: ``"ament_python"`` or ``"ament_cmake"``.
        programs: The console scripts that its setup.py names, as ``name = module:function``.
        interfaces: Its interface files.
        dependencies: Everything that package.xml depends on, ``member_of_group`` included.
        modules: Its Python files, as paths inside the package.
        commented: What package.xml would depend on, too, if the lines inside its comments counted.
    """

    name: str
    build_type: str
    programs: Sequence[str] = ()
    interfaces: Sequence[Interface] = ()
    dependencies: Sequence[str] = ()
    modules: Sequence[str] = ()
    commented: Sequence[str] = ()


@dataclass(frozen=True)
class WorkspaceReport:
    """How a build went.

    Attributes:
        phase: ``"found"`` before the build, ``"built"`` after it.
        built: Whether every package was built.
        trouble: Which kind of trouble: ``"no_workspace"``, ``"no_package"``, ``"bad_package"``, ``"build"``
            or
            empty.
        package: The package that failed, else empty.
        line: The one line that matters of a failure.
        log: The end of the log of a failure.
        packages: The packages of the workspace.
        missing: Of what the exercise asks for (a program, an interface), what is not there after the build.
    """

    phase: str
    built: bool
    trouble: str = ""
    package: str = ""
    line: str = ""
    log: str = ""
    packages: Sequence[PackageReport] = field(default=())
    missing: str = ""


def as_line(report: WorkspaceReport) -> str:
    """The line that travels; a log and interface files that are too long for it are cut."""
    for limit in (2_500, 1_200, 600, 200, 50):
        packages = [
            replace(
                p,
                interfaces=[replace(i, text=i.text[:limit]) for i in p.interfaces],
                modules=p.modules[: limit // 60],  # none where all else needs the room
                commented=p.commented[: limit // 60],
            )
            for p in report.packages
        ]
        cut = replace(report, log=report.log[-limit:], line=report.line[:limit], packages=packages)
        line = MARK + json.dumps(asdict(cut), ensure_ascii=False)
        if len(line.encode()) <= MAX_LINE:
            return line
    return MARK + json.dumps(asdict(replace(cut, packages=[])), ensure_ascii=False)


def report_of(part: Part, phase: str = "built") -> WorkspaceReport | None:
    """The first report of a phase; None where there is none, as where a command was run that built nothing."""
    return next((report for _, report in _reports(part) if report.phase == phase), None)


def build_ended(part: Part) -> float:
    """Seconds after the beginning of a part at which the workspace was built; 0 where nothing was built in it."""
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
    except (ValueError, TypeError, KeyError, AttributeError):
        return None
