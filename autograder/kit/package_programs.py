"""What is known of a package's programs: whether they were built, and where their entry points lead."""

from __future__ import annotations

from pathlib import PurePosixPath
from typing import TYPE_CHECKING

import re2

from autograder.kit.model import Advice, Look
from autograder.kit.workspace_report import report_of

if TYPE_CHECKING:
    from autograder.kit.evidence import Evidence
    from autograder.kit.model import Bench
    from autograder.kit.workspace_report import PackageReport, WorkspaceReport

BEGINNING = {Look.FAST: 4.0, Look.REAL_TIME: 15.0}
"""Seconds of wall time in which a program or its build must have said its first word."""
BUILDING = 180.0
"""Seconds of wall time that a build may take; a Python package needs one."""


def await_build(bench: Bench) -> None:
    """Wait until the workspace of a subject that was just started is built, where it is one."""
    bench.wait_until(
        lambda evidence: bool(evidence.main.of("output") or evidence.main.of("log")), BEGINNING[bench.look]
    )
    if bench.wait_until(lambda evidence: report_of(evidence.main, "found") is not None, 0.0):
        bench.wait_until(lambda evidence: report_of(evidence.main) is not None, BUILDING)


def _has_begun(evidence: Evidence) -> bool:
    return bool(evidence.main.of("output") or evidence.main.of("log"))


def package_of(report: WorkspaceReport | None, name: str) -> PackageReport | None:
    """The package of that name; None where it is not in the workspace, or there is no workspace."""
    return next((package for package in report.packages if package.name == name), None) if report else None


def entry_point(evidence: Evidence, package: str, program: str) -> Advice | None:
    """The package is there, and its setup.py does not name the program, or names what is not there."""
    line = f"'{program} = {package}.{program}:main',"
    report = report_of(evidence.main)
    if report is not None and report.built and report.missing == program:
        own = package_of(report, package)
        named = ", ".join(own.programs) if own else ""
        return Advice(
            f"The package is built, but it has no program {program}: "
            + (f"setup.py names only {named}." if named else "setup.py names no entry point."),
            f"In setup.py, 'console_scripts' must hold {line.rstrip(',')}. Then build again.",
        )
    tracebacks = "\n".join(part.traceback for part in evidence)
    found = re2.search(
        rf"No module named '{package}\.(?P<module>\w+)'|module '{package}\.\w+' has no attribute '(?P<name>\w+)'",
        tracebacks,
    )
    if found is None:
        return _unknown_module(tracebacks, package, program)
    what = f"the module {found['module']}" if found["module"] else f"the function {found['name']}"
    return Advice(
        f"The entry point in setup.py leads to {what}, which is not there.",
        f"It must read {line}: the file without .py, a colon, and the function.",
    )


_LED_NOWHERE = re2.compile(
    r"(?m)^ +return next\(matches\)\.load\(\)\n(?: +[~^]+\n)?"
    # All that is below the start of a program is Python's own: no file of the student's has imported anything yet.
    r"(?: +File \"[^\"\n]*(?:/importlib/|<frozen importlib)[^\n]*\n(?:    [^\n]*\n)*)*"
    r"ModuleNotFoundError: No module named '(?P<module>[\w.]+)'"
)


def _unknown_module(tracebacks: str, package: str, program: str) -> Advice | None:
    """The entry point names a module in another way than with the package before it."""
    found = _LED_NOWHERE.search(tracebacks)
    if found is None or found["module"] == package:
        return None
    return Advice(
        f"The entry point in setup.py names the module {found['module']}, which is not there. A module of the package "
        "is named with the package before it.",
        f"Write package, dot, file, without .py: '{program} = {package}.{program}:main'. Then build again.",
    )


def no_executable(evidence: Evidence, package: str, program: str) -> Advice | None:
    """`ros2 run` knows the package and finds no such program in it."""
    if not any("No executable found" in str(event.data["text"]) for event in evidence.main.of("output")):
        return None
    return Advice(
        "ros2 run found the package, but no program of that name in it.",
        f"Name the entry point in setup.py: '{program} = {package}.{program}:main'. Then build and source again.",
    )


def package_name(evidence: Evidence, package: str) -> Advice | None:
    """The workspace holds packages, and none of the task's name."""
    report = report_of(evidence.main)
    if report is None or not report.built or report.missing != package:
        return None
    names = ", ".join(known.name for known in report.packages)
    return Advice(
        f"The workspace was built, but the package {package} is not in it; there is {names}.",
        f"Make it in src with `ros2 pkg create --build-type ament_python {package} …`; <name> in package.xml counts, "
        "and setup.py must have the same.",
    )


def wrong_folder(evidence: Evidence, package: str, program: str) -> Advice | None:
    """The program's file is in the package, and not among its modules."""
    own = package_of(report_of(evidence.main), package)
    if own is None or f"{package}/{program}.py" in own.modules:
        return None
    lost = next((file for file in own.modules if PurePosixPath(file).name == f"{program}.py"), None)
    if lost is None or any(_module(entry) == _dotted(lost) for entry in own.programs):
        return None
    return Advice(
        f"{program}.py is in another folder than the package's modules: it is src/{package}/{lost}.",
        f"Move it to src/{package}/{package}/{program}.py, into the inner one of the two folders {package}, and build "
        "again.",
    )


def lost_entry_point(report: WorkspaceReport | None, package: str, program: str) -> bool:
    """Whether a module of an earlier lab is in the package, and no entry point of setup.py leads to it any more."""
    own = package_of(report, package)
    if own is None or f"{package}/{program}.py" not in own.modules:
        return False
    return not any(_module(entry) == f"{package}.{program}" for entry in own.programs)


def _module(entry: str) -> str:
    """The module of an entry point such as ``name = module:function``."""
    return entry.partition("=")[2].partition(":")[0].strip()


def _dotted(file: str) -> str:
    """A file as Python imports it."""
    return file.removesuffix(".py").replace("/", ".")
