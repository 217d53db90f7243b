"""Mistakes in a workspace: a build that failed, entry points in setup.py, the package's name, the modules' folder."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import PurePosixPath
from typing import TYPE_CHECKING

import re2

from autograder import known_errors
from autograder.kit.bench import Pace
from autograder.kit.mistakes.traceback_lines import own_line
from autograder.kit.model import Advice, Mistake, card_words, filled_in, mistake
from autograder.kit.output.workspace_reports import WorkspaceReport, report_of
from autograder.kit.runners import BUILDING

if TYPE_CHECKING:
    from autograder.kit.bench import Bench
    from autograder.kit.evidence import Evidence, Part
    from autograder.kit.output.workspace_reports import PackageReport

_WORDS = card_words(__file__)


def build_report(part: Part) -> WorkspaceReport | None:
    """Return the report made after the build; if there is none, the report made before the build."""
    return report_of(part) or report_of(part, "found")


def seen_of_build(report: WorkspaceReport) -> str:
    """Return the outcome of a build in a few words for the card."""
    if report.trouble in ("build", "entry_point"):
        why = _plain(report.line) or "its output says why"
        return f"colcon could not build {report.package or 'it'}: {why}"
    return report.line or report.trouble.replace("_", " ")


def _plain(line: str) -> str:
    """Return a line of a build without the codes with which a terminal shows colors."""
    return re2.sub(r"\x1b\[[\d;]*m", "", line).strip()


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
    line = _plain(report.line)
    known = known_errors.recognized(line, "build")
    usual = "Run `colcon build` in the workspace to see the whole log, and look for the first line with the word error."
    why, next_step = (known.means, known.do) if known else ("", usual)
    failed = f"colcon build fails in {report.package or 'the workspace'}: {line or 'its output says why'}"
    return Advice(f"{failed}{why and f' {why}'}", next_step)


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
        *_WORDS["no_workspace"],
        certain=True,
    ),
    mistake(
        "bad_package",
        lambda evidence: _trouble(evidence, "bad_package"),
        *_WORDS["bad_package"],
        certain=True,
    ),
    mistake("syntax_error", _unreadable, *_WORDS["syntax_error"], certain=True),
    mistake(
        "entry_point",
        lambda evidence: _trouble(evidence, "entry_point"),
        *_WORDS["entry_point"],
        certain=True,
    ),
    Mistake("build_failed", _build_failed, certain=True),
)
"""Mistakes that keep a workspace from being built."""


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


BEGINNING = {Pace.FAST: 4.0, Pace.REAL_TIME: 15.0}
"""For each pace, the time limit in seconds of wall time until a program or its build must print a first line."""


def await_build(bench: Bench) -> None:
    """Wait until the subject's workspace is built. Return at once if the subject is not a workspace."""
    # This wait has a time limit, because a command may print nothing while it waits for the judge.
    bench.await_sign_of_life(BEGINNING[bench.pace])
    if bench.wait_until(lambda evidence: report_of(evidence.main, "found") is not None, 0.0):
        bench.wait_until(lambda evidence: report_of(evidence.main) is not None, BUILDING)


def package_of(report: WorkspaceReport | None, name: str) -> PackageReport | None:
    """Return a workspace's package with this name; None if there is no such package or no workspace."""
    return next((package for package in report.packages if package.name == name), None) if report else None


FORM = "a string of this form: executable = package.module:function, with no slash and no parentheses"


def entry_point(evidence: Evidence, entry: EntryPoint) -> Advice | None:
    """Return advice if setup.py lacks the task's entry point, or names a module or function that does not exist."""
    report, again = report_of(evidence.main), _again(evidence)
    if report is not None and report.built and report.missing == entry.program:
        own = package_of(report, entry.package)
        named = ", ".join(own.programs) if own else ""
        # If setup.py has no entry point yet, the advice shows only the format, because the exact line would be the
        # answer.
        return filled_in(
            _WORDS["no_entry_point"],
            entry=entry,
            named=named or "no entry point of the right form",
            line=entry.line if named else FORM,
            again=again,
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
    return filled_in(
        _WORDS["leads_nowhere"],
        traceback=tracebacks,
        what=what,
        missing=", which does not exist" * bool(name),
        entry=entry,
        again=again,
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
    return filled_in(_WORDS["no_executable"], entry=entry)


def package_name(evidence: Evidence, package: str) -> Advice | None:
    """Return advice if the workspace contains packages, but none with the name from the task."""
    report = report_of(evidence.main)
    if report is None or not report.built or report.missing != package:
        return None
    names = ", ".join(known.name for known in report.packages)
    return filled_in(_WORDS["package_name"], package=package, names=names)


def wrong_folder(evidence: Evidence, entry: EntryPoint) -> Advice | None:
    """Return advice if the program's file is in the package, but not in the folder of the package's modules."""
    package, file = entry.package, f"{entry.module}.py"
    report = report_of(evidence.main)
    own = package_of(report, package)
    if report is None or own is None or not report.complete or f"{package}/{file}" in own.modules:
        return None
    lost = next((known for known in own.modules if PurePosixPath(known).name == file), None)
    if lost is None or any(
        _module(named) == lost.removesuffix(".py").replace("/", ".") for named in own.programs
    ):
        return None
    return filled_in(_WORDS["wrong_folder"], file=file, package=package, lost=lost)


def mistakes(entry: EntryPoint) -> tuple[Mistake, ...]:
    """Return the mistakes of a package that does not have the task's program, most specific first."""
    return (
        Mistake("wrong_folder", lambda evidence: wrong_folder(evidence, entry), certain=True),
        Mistake("entry_point", lambda evidence: entry_point(evidence, entry), certain=True),
        Mistake("entry_point", lambda evidence: no_executable(evidence, entry), certain=True),
    )


def in_package(package: str, *entries: EntryPoint) -> tuple[Mistake, ...]:
    """Return the mistakes of a workspace that must have a package, with the programs of these entry points."""
    return (
        *BUILD,
        Mistake("package_name", lambda evidence: package_name(evidence, package), certain=True),
        *(known for entry in entries for known in mistakes(entry)),
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
