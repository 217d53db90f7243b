"""A package's programs, as reported before and after its build, and the modules that their entry points name."""

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
"""Time limit in seconds of wall time, for each pace, in which a program or its build must print its first line."""


@dataclass(frozen=True)
class Entry:
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
    """Wait until the workspace of a just started subject is built. Return at once if the subject is not a workspace."""
    # A command may print nothing while it waits for the judge, so this wait has a time limit.
    bench.await_sign_of_life(BEGINNING[bench.pace])
    if bench.wait_until(lambda evidence: report_of(evidence.main, "found") is not None, 0.0):
        bench.wait_until(lambda evidence: report_of(evidence.main) is not None, BUILDING)


def package_of(report: WorkspaceReport | None, name: str) -> PackageReport | None:
    """Return the package with this name; None if the workspace does not contain it, or if there is no workspace."""
    return next((package for package in report.packages if package.name == name), None) if report else None


def entry_point(evidence: Evidence, entry: Entry) -> Advice | None:
    """Return advice if setup.py does not declare the task's program, or names a function that does not exist."""
    report, again = report_of(evidence.main), _again(evidence)
    if report is not None and report.built and report.missing == entry.program:
        own = package_of(report, entry.package)
        named = ", ".join(own.programs) if own else ""
        # Without any entry point so far, the advice shows only the format, because the line itself would be the
        # answer.
        return Advice(
            f"The package is built, but it has no program {entry.program}: setup.py names "
            f"{named or 'no entry point of the right form'}.",
            f"In setup.py, the list 'console_scripts' has to contain {entry.line if named else FORM}. setup.cfg "
            f"beside it has to put programs into $base/lib/{entry.package}. {again}",
        )
    # If a traceback shows only Python's own code after the line that starts the program, the program failed before it
    # imported any of the student's files.
    started = (part.traceback for part in evidence if _STARTS.search(part.traceback))
    tracebacks = "\n".join(text for text in started if _STARTS.search(own_line(text) or text))
    found = _LED_NOWHERE.search(tracebacks)
    if found is None or found["module"] == entry.package:
        return None
    name = found["module"] or found["name"]
    what = (
        f"the {'module' if found['module'] else 'function'} {name}"
        if name
        else "a module, and to no function in it"
    )
    return Advice(
        f"The entry point in setup.py leads to {what}{', which is not there' * bool(name)}.",
        f"Write {entry.line}, with a comma after it: package, dot, the file without .py, a colon, and the function. "
        f"{again}",
        tracebacks,
    )


_STARTS = re2.compile(r"next\(matches\)\.load\(\)|load_entry_point\(")
"""The lines that import the module and call the function, in the script that a build makes for an entry point."""
_LED_NOWHERE = re2.compile(
    r"(?m)^ModuleNotFoundError: No module named '(?P<module>[\w.]+)'"
    r"|module '[\w.]+' has no attribute '(?P<name>\w+)'"
    r"|load_entry_point\(.*\)\(\)\)\n(?:[ ~^]*\n)?TypeError: 'module' object is not callable"
)


def _again(evidence: Evidence) -> str:
    """Return the next step after a change. The judge builds a workspace; `ros2 run` starts an earlier build."""
    return (
        "Then build and check again."
        if report_of(evidence.main) is None
        else "Then check again; the judge builds the workspace for you."
    )


def no_executable(evidence: Evidence, entry: Entry) -> Advice | None:
    """Return advice if `ros2 run` finds the package, but not the program in it."""
    if not any("No executable found" in str(event.data["text"]) for event in evidence.main.of("output")):
        return None
    return Advice(
        "ros2 run found the package, but no program of that name in it.",
        f"Name the entry point in setup.py: {entry.line}. Then build and source again.",
    )


def package_name(evidence: Evidence, package: str) -> Advice | None:
    """Return advice if the workspace contains packages, but none with the name from the task."""
    report = report_of(evidence.main)
    if report is None or not report.built or report.missing != package:
        return None
    names = ", ".join(known.name for known in report.packages)
    return Advice(
        f"The workspace was built, but the package {package} is not in it; there is {names}.",
        f"The name of a package is its <name> in package.xml. Write {package} there, as the name in setup.py, and in "
        "the paths in setup.cfg. The folder with your modules and the file in resource need this name, too.",
    )


def wrong_folder(evidence: Evidence, entry: Entry) -> Advice | None:
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
        f"{file} is not in the folder of the package's modules: it is src/{package}/{lost}.",
        f"Move it to src/{package}/{package}/{file}, into the inner one of the two folders {package}. Then check "
        "again; the judge builds the package for you.",
    )


def mistakes(entry: Entry) -> tuple[Mistake, ...]:
    """Return the mistakes of a package that does not have the task's program, most specific first."""
    return (
        Mistake("wrong_folder", lambda evidence: wrong_folder(evidence, entry), certain=True),
        Mistake("entry_point", lambda evidence: entry_point(evidence, entry), certain=True),
        Mistake("entry_point", lambda evidence: no_executable(evidence, entry), certain=True),
    )


def lost_entry_point(report: WorkspaceReport | None, package: str, program: str) -> bool:
    """Return True if the package contains the module of an earlier lab, but no program starts that module any more.

    Installed programs count as well, because setup.py may compute an entry point that its text does not show.
    """
    own = package_of(report, package)
    if own is None or f"{package}/{program}.py" not in own.modules or program in own.installed:
        return False
    return not any(_module(entry) == f"{package}.{program}" for entry in own.programs)


def _module(entry: str) -> str:
    """Return the module of an entry point such as ``name = module:function``."""
    return entry.partition("=")[2].partition(":")[0].strip()


def _dotted(file: str) -> str:
    """Return a file's path as a module name that Python can import."""
    return file.removesuffix(".py").replace("/", ".")
