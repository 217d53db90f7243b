"""Mistakes of a package's programs: entry points in setup.py, the package's name, and the folder of its modules."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import PurePosixPath
from typing import TYPE_CHECKING

import re2

from autograder.kit.mistakes.names_in_tracebacks import own_line
from autograder.kit.model import Advice, Mistake, Pace
from autograder.kit.workspace_report import BUILDING, report_of

if TYPE_CHECKING:
    from autograder.kit.evidence import Evidence
    from autograder.kit.model import Bench
    from autograder.kit.workspace_report import PackageReport, WorkspaceReport

BEGINNING = {Pace.FAST: 4.0, Pace.REAL_TIME: 15.0}
"""For each pace, the time limit in seconds of wall time until a program or its build must print a first line."""


@dataclass(frozen=True)
class EntryPoint:
    """The entry point in setup.py that a task requires.

    Attributes:
        package: The name of the package.
        program: The name of the program for ``ros2 run``.
        file: The name of the program's file without ``.py``; empty if it equals the program's name.
    """

    package: str
    program: str
    file: str = ""

    @property
    def module(self) -> str:
        """The name of the program's file, without ``.py``."""
        return self.file or self.program

    @property
    def line(self) -> str:
        """The line in setup.py that declares the entry point."""
        return f"'{self.program} = {self.package}.{self.module}:main'"


FORM = "a string of this form: executable = package.module:function, with no slash and no parentheses"


def await_build(bench: Bench) -> None:
    """Wait until the subject's workspace is built. Return at once if the subject is not a workspace."""
    # This wait has a time limit, because a command may print nothing while it waits for the judge.
    bench.await_sign_of_life(BEGINNING[bench.pace])
    if bench.wait_until(lambda evidence: report_of(evidence.main, "found") is not None, 0.0):
        bench.wait_until(lambda evidence: report_of(evidence.main) is not None, BUILDING)


def package_of(report: WorkspaceReport | None, name: str) -> PackageReport | None:
    """Return a workspace's package with this name; None if there is no such package or no workspace."""
    return next((package for package in report.packages if package.name == name), None) if report else None


def entry_point(evidence: Evidence, entry: EntryPoint) -> Advice | None:
    """Return advice if setup.py lacks the task's entry point, or names a module or function that does not exist."""
    report, again = report_of(evidence.main), _again(evidence)
    if report is not None and report.built and report.missing == entry.program:
        own = package_of(report, entry.package)
        named = ", ".join(own.programs) if own else ""
        # If setup.py has no entry point yet, the advice shows only the format, because the exact line would be the
        # answer.
        return Advice(
            f"The package was built, but it has no program {entry.program}: setup.py names "
            f"{named or 'no entry point of the right form'}.",
            f"In setup.py, the list 'console_scripts' must contain {entry.line if named else FORM}. In setup.cfg "
            f"next to it, programs must go to $base/lib/{entry.package}. {again}",
        )
    # If the traceback ends in Python's code that loads the entry point, the program failed before it imported any file
    # of the student.
    started = (part.traceback for part in evidence if _STARTS.search(part.traceback))
    tracebacks = "\n".join(text for text in started if _STARTS.search(own_line(text) or text))
    found = _LED_NOWHERE.search(tracebacks)
    if found is None or found["module"] == entry.package:
        return None
    name = found["module"] or found["name"]
    what = (
        f"the {'module' if found['module'] else 'function'} {name}"
        if name
        else "a module, but not to a function in it"
    )
    return Advice(
        f"The entry point in setup.py points to {what}{', which does not exist' * bool(name)}.",
        f"Write {entry.line} and a comma after it. This is the program, the package, a dot, the file without .py, a "
        f"colon, and the function. {again}",
        tracebacks,
    )


_STARTS = re2.compile(r"next\(matches\)\.load\(\)|load_entry_point\(")
"""Matches the lines that load the entry point in the script that a build makes for a program."""
_LED_NOWHERE = re2.compile(
    r"(?m)^ModuleNotFoundError: No module named '(?P<module>[\w.]+)'"
    r"|module '[\w.]+' has no attribute '(?P<name>\w+)'"
    r"|load_entry_point\(.*\)\(\)\)\n(?:[ ~^]*\n)?TypeError: 'module' object is not callable"
)


def _again(evidence: Evidence) -> str:
    """Return the next step after a correction, which depends on whether the judge builds the workspace itself."""
    return (
        "Then build and check again."
        if report_of(evidence.main) is None
        else "Then check again; the judge builds the workspace for you."
    )


def no_executable(evidence: Evidence, entry: EntryPoint) -> Advice | None:
    """Return advice if `ros2 run` finds the package, but not the program in it."""
    if not any("No executable found" in str(event.data["text"]) for event in evidence.main.of("output")):
        return None
    return Advice(
        "`ros2 run` found the package, but no program with this name in it.",
        f"Write the entry point in setup.py as {entry.line}. Then build and source the workspace again.",
    )


def package_name(evidence: Evidence, package: str) -> Advice | None:
    """Return advice if the workspace contains packages, but none with the name from the task."""
    report = report_of(evidence.main)
    if report is None or not report.built or report.missing != package:
        return None
    names = ", ".join(known.name for known in report.packages)
    return Advice(
        f"The workspace was built, but it does not contain the package {package}; it contains {names}.",
        f"The name of a package is its <name> in package.xml. Write {package} in all these places: <name> in "
        "package.xml, name in setup.py, the paths in setup.cfg, the folder with your modules, and the file in the "
        "folder resource.",
    )


def wrong_folder(evidence: Evidence, entry: EntryPoint) -> Advice | None:
    """Return advice if the program's file is in the package, but not in the folder of the package's modules."""
    package, file = entry.package, f"{entry.module}.py"
    report = report_of(evidence.main)
    own = package_of(report, package)
    if report is None or own is None or not report.complete or f"{package}/{file}" in own.modules:
        return None
    lost = next((known for known in own.modules if PurePosixPath(known).name == file), None)
    if lost is None or any(_module(named) == _dotted(lost) for named in own.programs):
        return None
    return Advice(
        f"{file} is not in the folder with the package's modules, but at src/{package}/{lost}.",
        f"Move {file} to src/{package}/{package}/{file}: the path contains {package} twice. Then check again; the "
        "judge builds the package for you.",
    )


def mistakes(entry: EntryPoint) -> tuple[Mistake, ...]:
    """Return the mistakes of a package that does not have the task's program, most specific first."""
    return (
        Mistake("wrong_folder", lambda evidence: wrong_folder(evidence, entry), certain=True),
        Mistake("entry_point", lambda evidence: entry_point(evidence, entry), certain=True),
        Mistake("entry_point", lambda evidence: no_executable(evidence, entry), certain=True),
    )


def lost_entry_point(report: WorkspaceReport | None, package: str, program: str) -> bool:
    """Return True if the package contains the module of an earlier lab, but no program starts that module.

    An installed program counts even if the text of setup.py does not show its entry point, because setup.py may compute
    it.
    """
    own = package_of(report, package)
    if own is None or f"{package}/{program}.py" not in own.modules or program in own.installed:
        return False
    return not any(_module(entry) == f"{package}.{program}" for entry in own.programs)


def _module(entry: str) -> str:
    """Return the module of an entry point such as ``name = module:function``."""
    return entry.partition("=")[2].partition(":")[0].strip()


def _dotted(file: str) -> str:
    """Return a file's path as the name with which Python imports it."""
    return file.removesuffix(".py").replace("/", ".")
