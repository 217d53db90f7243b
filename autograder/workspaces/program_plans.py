"""An exercise's plan for a workspace: the packages that it needs, what they must contain, and what to run."""

from __future__ import annotations

import functools
import os
import shutil
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import re2

from autograder import course
from autograder.kit.output.workspace_reports import AMENT_PACKAGE
from autograder.kit.runners import ALONE, LaunchesFromPackage, RunsProgram, RunsPrograms, ServesInterface
from autograder.workspaces.builds.install_folder import files_of_interfaces, has_service, is_indexed
from autograder.workspaces.packages import LAUNCH_LANGUAGES, WORKSPACE, launch_files
from autograder.workspaces.sources import ByteBudget
from course_runtime.python_child import installed_program, python_child

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from autograder.workspaces.builds.colcon_build import Build, Targets
    from autograder.workspaces.packages import Package


@dataclass(frozen=True)
class Plan:
    """The plan of an exercise about a workspace.

    Attributes:
        targets: Returns the names of the packages that the exercise needs; no names if it needs all packages.
        missing: Returns the name of a package, program or file that the exercise needs and the build lacks; empty if
            nothing is missing.
        command: Returns the command to run in the environment of the build. It is called only if nothing is missing.
        definition: The name of the interface file that the exercise is about; empty if there is none.
        launches: Returns the path of the installed launch file; None if the exercise launches none.
    """

    targets: Targets
    missing: Callable[[Build], str]
    command: Callable[[Build], Sequence[str]]
    definition: str = ""
    launches: Callable[[Build], Path | None] = lambda _: None


def plan_for(
    runner: RunsProgram | RunsPrograms | ServesInterface | LaunchesFromPackage, arguments: Sequence[str] = ()
) -> Plan:
    """Return the plan for the program, launch or interface that an exercise runs from a workspace.

    Args:
        runner: The exercise's runner, such as :class:`autograder.kit.runners.RunsProgram`.
        arguments: The arguments with which the program is started this time. If the exercise has several programs, the
            first argument names one. The arguments of a launch may name a program to run instead of the launch.
    """
    match runner:
        case RunsProgram(package=package, program=program):
            return _program_plan(package, program, arguments)
        case RunsPrograms(package=package):
            return _program_plan(package, arguments[0], arguments[1:])
        case ServesInterface():
            return _interface_plan(runner)
        case LaunchesFromPackage(package=package, file=file):
            return _launch_plan(package, file, arguments)


def _program_plan(package: str, program: str, arguments: Sequence[str]) -> Plan:
    return Plan(
        targets=lambda found: [known.name for known in found.packages if known.name == package],
        missing=lambda made: _missing(made, package, program, made.programs(package)),
        command=lambda _: [ros2(), "run", package, program, *arguments],
    )


def _missing(made: Build, package: str, wanted: str, there: Iterable[str]) -> str:
    """Return the missing name: ``package`` if it was not built, ``wanted`` if it is not in ``there``; else empty."""
    if not any(prefix.name == package for prefix in made.prefixes):
        return package
    return "" if wanted in there else wanted


def _launch_plan(package: str, file: str, arguments: Sequence[str]) -> Plan:
    def targets(found: Build) -> list[str]:
        folders = [known.folder for known in found.packages if known.name == package]
        named = {name for path in _of_name(file, folders) for name in launch_targets(path)(found)}
        return [known.name for known in found.packages if known.name in {package, *named}]

    def installed(made: Build) -> list[Path]:
        """Return the launch files with this name that `ros2 launch` would find, in the first language that has any."""
        shares = [prefix / "share" / package for prefix in made.prefixes if prefix.name == package]
        found = _of_name(file, shares)
        return [path for path in found if path.name == found[0].name]

    def command(made: Build) -> Sequence[str]:
        return single_program_command(arguments) or [ros2(), "launch", package, installed(made)[0].name]

    return Plan(
        targets=targets,
        missing=lambda made: _missing(made, package, file, [path.stem for path in installed(made)]),
        command=command,
        launches=lambda made: next(iter(installed(made)), None),
    )


def _of_name(file: str, folders: Iterable[Path]) -> list[Path]:
    """Return the launch files with this name (without extension) in some folders, sorted by language."""
    found = [folder / path for folder in folders for path in launch_files(folder)]
    return sorted(
        (path for path in found if path.stem == file), key=lambda path: LAUNCH_LANGUAGES.index(path.suffix)
    )


def _interface_plan(runner: ServesInterface) -> Plan:
    interface = Path(runner.file).stem

    def holders(found: Build) -> list[Package]:
        return [p for p in found.packages if any(file.stem == interface for file in p.interface_files)]

    def generated(made: Build) -> list[Path]:
        names = {package.name for package in holders(made)}
        return [p for p in made.prefixes if p.name in names and has_service(p, interface)]

    def missing(made: Build) -> str:
        # A generated type is not enough: ROS finds a package only if the ament index has an entry for it.
        entered = any(map(is_indexed, generated(made)))
        return "" if entered else AMENT_PACKAGE if generated(made) else runner.file

    def probe(made: Build) -> Sequence[str]:
        service_type = f"{generated(made)[0].name}/srv/{interface}"
        return python_child(
            "-m", "autograder.workspaces.interface_probe", service_type, runner.service
        ).command

    return Plan(
        targets=lambda found: [package.name for package in holders(found)],
        missing=missing,
        command=probe,
        definition=runner.file,
    )


def launch_targets(file: Path) -> Targets:
    """Return a function that finds the packages named in a launch file, or in a file that the launch file includes."""

    def targets(found: Build) -> list[str]:
        words = _launch_words(file, found)
        return [package.name for package in found.packages if words is None or package.name in words]

    return targets


def single_program_command(arguments: Sequence[str]) -> Sequence[str]:
    """Return the command for the single program that the arguments name; empty if the whole launch is to be run."""
    words = list(arguments)
    return [ros2(), "run", *words[words.index(ALONE) + 1 :]] if ALONE in words else []


def lacks_programs(file: Path, made: Build, course_build: Build) -> bool:
    """Return True if a launch file starts programs of the course's package that the student's package does not have.

    This is so if a student wrote talker and listener only in the notebooks. The words in the launch file decide: the
    result is True if they include a program that only the course has, and no program that only the student has. In a
    launch file with a program of the student, ``talker`` may be just a variable, a node's name or part of a comment.
    """
    words, own, given = _launch_words(file, made), _programs(made), _programs(course_build)
    if words is None:
        return False
    return bool(words & given - own) and not words & own - given


def reference_workspace() -> Path:
    """Return the workspace with the course's own talker and listener, which students do not receive."""
    return course.root() / "solutions" / WORKSPACE


@functools.cache
def course_interfaces() -> tuple[Path, ...]:
    """Return all files and folders of the course's own interfaces.

    They are hidden from a build of interfaces, because copies of them would look like newly generated files.
    """
    prefixes = {sys.prefix, *os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep)} - {""}
    packages = course.interfaces()
    return tuple(
        sorted(f for one in prefixes for package in packages for f in files_of_interfaces(Path(one), package))
    )


def ros2() -> str:
    """Return the path of the ``ros2`` command of this environment."""
    beside = installed_program("ros2")
    return str(beside) if beside.exists() else shutil.which("ros2") or "ros2"


_LAUNCH_FILES = ("launch.py", ".xml", ".yaml", ".yml")
"""The name endings of launch files."""
_LARGEST = 500_000
"""The maximum size in bytes of a launch file and all files that it includes, because a student's folder may contain
files of any size.
"""


def _launch_words(file: Path, build: Build) -> set[str] | None:
    """Return the words in a launch file and in the files whose names it contains; None if there is too much to parse.

    Tags and keys are returned with their punctuation, such as ``<node`` and ``node:``, so that they differ from names.
    """
    near = [
        *file.parent.iterdir(),
        *(path for package in build.packages for path in package.folder.rglob("*")),
    ]
    others = {
        path
        for path in near
        if path.name.endswith(_LAUNCH_FILES) and path.is_file() and path.stat().st_size <= _LARGEST
    }
    budget, words = ByteBudget(_LARGEST), set[str]()
    unread = {file}
    while unread:
        if not all(map(budget.has, unread)):
            return None
        others -= unread
        text = "\n".join(path.read_text(encoding="utf-8", errors="replace") for path in unread)
        words.update(re2.findall(r"</?\w+|\w+:?", text))
        unread = {path for path in others if path.name in text}
    return words


def _programs(made: Build) -> set[str]:
    return {program for prefix in made.prefixes for program in made.programs(prefix.name)}
