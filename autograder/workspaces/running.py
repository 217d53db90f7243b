"""Run what is in a workspace as the subject of a check: build it, report, then become the student's program.

The judge starts this as a process (or the notebook does, at the judge's word) and reads its output. What it reports
about the build goes before everything that a program of the student's says.
"""

from __future__ import annotations

import os
import shutil
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from autograder import exercises
from autograder.exercises.lab_1_1_hello import PACKAGE, PROGRAM
from autograder.exercises.lab_1_3_interface import INTERFACE_FILE, SERVICE
from autograder.exercises.workspace_report import Interface, PackageReport, WorkspaceReport, as_line
from autograder.workspaces.building import Build, build, look
from autograder.workspaces.launching import launch
from autograder.workspaces.prefixes import with_prefixes
from autograder.workspaces.processes import end_with_the_parent, tell

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from autograder.workspaces.packages import Package

MAX_TEXT = 4_000
"""Characters of an interface file that are reported."""
MAX_LOG = 3_000
"""Characters of a build's log that are reported: its end."""


def hello(path: str) -> int:
    """Build the workspace and become ``ros2 run`` of the lab's program."""
    report(look(Path(path)), "found")
    made = build(Path(path))
    program = [prefix / "lib" / PACKAGE / PROGRAM for prefix in made.prefixes if prefix.name == PACKAGE]
    missing = ""
    if made.ok and not program:
        missing = PACKAGE
    elif made.ok and not program[0].is_file():
        missing = PROGRAM
    report(made, "built", missing)
    if not made.ok or missing:
        return 1
    _become([ros2(), "run", PACKAGE, PROGRAM], made)
    return 1


def interface(path: str) -> int:
    """Report the interface files, build the workspace and become a program that serves the interface."""
    workspace = Path(path)
    found = look(workspace)
    report(found, "found")
    if found.trouble:
        return 1
    made = build(workspace)
    name = Path(INTERFACE_FILE).stem
    holders = [package for package in made.packages if any(f.stem == name for f in package.interface_files)]
    built = [
        p
        for p in holders
        for prefix in made.prefixes
        if prefix.name == p.name and _generated(prefix, p.name, name)
    ]
    report(made, "built", "" if built or not made.ok else INTERFACE_FILE)
    if not built:
        return 1
    probe = [sys.executable, "-m", "autograder.workspaces.probe", f"{built[0].name}/srv/{name}", SERVICE]
    _become(probe, made)
    return 1


RUNNERS: dict[str, Callable[[str], int]] = {"hello": hello, "interface": interface}
"""What to do with a path, by the name that an exercise gives."""


def main(arguments: Sequence[str]) -> int:
    """``python -m autograder.workspaces EXERCISE PATH``, or ``EXERCISE -- COMMAND`` for a launch command."""
    exercise = exercises.get(arguments[0])
    end_with_the_parent()
    if exercise.runner == "launch":
        return _launch(arguments[1:])
    if exercise.runner not in RUNNERS or len(arguments) != 2:
        print(f"{exercise.id} takes no path: give it the class or function, or a command", file=sys.stderr)
        return 2
    return RUNNERS[exercise.runner](arguments[1])


def _launch(rest: Sequence[str]) -> int:
    if rest[0] == "--":
        return launch(rest[1:], None, report)
    if not Path(rest[0]).is_file():
        print(f"there is no launch file {rest[0]}", file=sys.stderr)
        return 1
    return launch([ros2(), "launch", rest[0]], Path(rest[0]), report)


def report(made: Build, phase: str, missing: str = "") -> None:
    """Print a report for the judge."""
    line = as_line(
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
    tell(line)


def ros2() -> str:
    """The ``ros2`` command of this environment."""
    beside = Path(sys.executable).with_name("ros2")
    return str(beside) if beside.exists() else shutil.which("ros2") or "ros2"


def _become(command: Sequence[str], made: Build) -> None:
    environment = with_prefixes(os.environ, made.prefixes)
    os.execvpe(command[0], list(command), environment)


def _generated(prefix: Path, package: str, name: str) -> bool:
    return any(prefix.rglob(f"{package}/srv/_{_snake(name)}.py"))


def _snake(name: str) -> str:
    return "".join(f"_{c.lower()}" if c.isupper() and i else c.lower() for i, c in enumerate(name))


def _described(package: Package) -> PackageReport:
    return PackageReport(
        package.name,
        package.build_type,
        package.programs,
        [_interface(package, file) for file in package.interface_files],
        package.dependencies,
    )


def _interface(package: Package, file: Path) -> Interface:
    text = (package.folder / file).read_text(encoding="utf-8", errors="replace")[:MAX_TEXT]
    return Interface(file.as_posix(), text, file.name in package.cmake_lists)
