"""An exercise's plan for a workspace: the packages that it needs, what they must contain, and the command to run."""

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
from autograder.kit.runners import ALONE, LaunchesFromPackage, RunsProgram, RunsPrograms, ServesInterface
from autograder.kit.workspace_report import AMENT_PACKAGE
from autograder.workspaces.byte_budget import ByteBudget
from autograder.workspaces.install_folder import files_of_interfaces, has_service, is_indexed
from autograder.workspaces.packages import LAUNCH_LANGUAGES, WORKSPACE, launch_files
from environment.python_child import installed_program, python_child

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from autograder.workspaces.colcon import Build
    from autograder.workspaces.packages import Package

_LAUNCH_FILES = ("launch.py", ".xml", ".yaml", ".yml")
"""The name endings of launch files."""
_LARGEST = 500_000
"""The limit in bytes for a launch file and all files that it includes; a student's folder may contain files of any
size.
"""


@dataclass(frozen=True)
class Plan:
    """The plan of an exercise about a workspace.

    Attributes:
        targets: The packages that it needs, by name; none of them means all that there are.
        missing: What it asks for and the build has not brought; empty where all is there.
        command: Returns the command, to be run in the environment of the build. Called only if nothing is missing.
        definition: The name of the interface file that the exercise is about; empty if there is none.
        launches: The path of the installed launch file; None if the exercise launches none.
    """

    targets: Callable[[Build], Iterable[str]]
    missing: Callable[[Build], str]
    command: Callable[[Build], Sequence[str]]
    definition: str = ""
    launches: Callable[[Build], Path | None] = lambda _: None


def plan_for(
    runner: RunsProgram | RunsPrograms | ServesInterface | LaunchesFromPackage, arguments: Sequence[str] = ()
) -> Plan:
    """The plan for what an exercise runs in a workspace.

    Args:
        runner: What the exercise runs.
        arguments: The arguments of this start; if there are several programs, the first argument is the name of one.
            Those of a launch may name a program that runs instead.
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
    """The package, if it was not built; what is wanted of the package, if it is not there; else empty."""
    if not any(prefix.name == package for prefix in made.prefixes):
        return package
    return "" if wanted in there else wanted


def _launch_plan(package: str, file: str, arguments: Sequence[str]) -> Plan:
    def targets(found: Build) -> list[str]:
        folders = [known.folder for known in found.packages if known.name == package]
        named = {name for path in _of_name(file, folders) for name in launch_targets(path)(found)}
        return [known.name for known in found.packages if known.name in {package, *named}]

    def installed(made: Build) -> list[Path]:
        """The files that `ros2 launch` finds of this name, in the first language in which there is one."""
        shares = [prefix / "share" / package for prefix in made.prefixes if prefix.name == package]
        found = _of_name(file, shares)
        return [path for path in found if path.name == found[0].name]

    def command(made: Build) -> Sequence[str]:
        # Launch by path: by name, ros2 finds the course's package first if the student's package lacks the programs.
        paths = installed(made)
        name = [str(paths[0])] if len(paths) == 1 else [package, paths[0].name]
        return alone(arguments) or [ros2(), "launch", *name]

    return Plan(
        targets=targets,
        missing=lambda made: _missing(made, package, file, [path.stem for path in installed(made)]),
        command=command,
        launches=lambda made: next(iter(installed(made)), None),
    )


def _of_name(file: str, folders: Iterable[Path]) -> list[Path]:
    """The launch files of this name, without its language's ending, in some folders; in the order of the languages."""
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
        entered = any(map(is_indexed, generated(made)))
        return "" if entered else AMENT_PACKAGE if generated(made) else runner.file

    def probe(made: Build) -> Sequence[str]:
        service_type = f"{generated(made)[0].name}/srv/{interface}"
        return python_child("-m", "autograder.workspaces.probe", service_type, runner.service).command

    return Plan(
        targets=lambda found: [package.name for package in holders(found)],
        missing=missing,
        command=probe,
        definition=runner.file,
    )


def launch_targets(file: Path) -> Callable[[Build], Iterable[str]]:
    """Return a function that finds the packages whose names are in a launch file, or in one that it includes.

    Args:
        file: The launch file, in any language.
    """

    def targets(found: Build) -> list[str]:
        words = _launch_words(file, found)
        return [package.name for package in found.packages if words is None or package.name in words]

    return targets


def alone(arguments: Sequence[str]) -> Sequence[str]:
    """Return the command for the single program that the arguments name; empty if they ask for a launch."""
    words = list(arguments)
    return [ros2(), "run", *words[words.index(ALONE) + 1 :]] if ALONE in words else []


def lacks_programs(file: Path, made: Build, course_build: Build) -> bool:
    """True if a launch file starts programs of the course's package that the student's package does not have.

    A student who wrote talker and listener only in the notebooks has no programs to launch. A student who launches
    programs with other names has them: ``talker`` is then a variable, a node's name or a word in a comment.
    """
    words, own, given = _launch_words(file, made), _programs(made), _programs(course_build)
    if words is None:
        return False
    return bool(words & given - own) and not words & own - given


def reference_workspace() -> Path:
    """Return the workspace with the course's own talker and listener; students do not receive it."""
    return course.root() / "solutions" / WORKSPACE


@functools.cache
def course_interfaces() -> tuple[Path, ...]:
    """Return all files and folders of the course's own interfaces.

    A build that makes interfaces must not find these: copies of them would look like generated ones.
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


def _launch_words(file: Path, build: Build) -> set[str] | None:
    """Return the words of a launch file and of the files that it includes: those whose names are in its text.

    Tags and keys, such as ``<node`` and ``node:``, are not among the words. None if the files are too long to parse.
    """
    near = [
        *file.parent.iterdir(),
        *(path for package in build.packages for path in package.folder.rglob("*")),
    ]
    others = {path for path in near if path.name.endswith(_LAUNCH_FILES) and _is_small(path)}
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


def _is_small(path: Path) -> bool:
    return path.is_file() and path.stat().st_size <= _LARGEST


def _programs(made: Build) -> set[str]:
    return {program for prefix in made.prefixes for program in made.programs(prefix.name)}
