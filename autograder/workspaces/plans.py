"""What an exercise does with a workspace: which packages it needs, what must be there then, and what is run."""

from __future__ import annotations

import functools
import os
import re
import shutil
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from autograder import course
from autograder.exercises.lab_1_1_hello import PACKAGE, PROGRAM
from autograder.exercises.lab_1_3_interface import INTERFACE_FILE, SERVICE
from autograder.workspaces.finding import WORKSPACE

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from autograder.workspaces.building import Build
    from autograder.workspaces.packages import Package

COURSE_PACKAGE = "my_robot_interfaces"
"""The interfaces that come with the course, so that later labs do not need those of the student."""
_INTERFACE = Path(INTERFACE_FILE).stem


@dataclass(frozen=True)
class Plan:
    """An exercise about a workspace.

    Attributes:
        targets: The packages that it needs, by name; none of them means all that there are.
        missing: What it asks for and the build has not brought; empty where all is there.
        command: What is run, in the environment of the build. Asked for only where nothing is missing.
    """

    targets: Callable[[Build], Iterable[str]]
    missing: Callable[[Build], str]
    command: Callable[[Build], Sequence[str]]


def _hello_missing(made: Build) -> str:
    programs = [prefix / "lib" / PACKAGE / PROGRAM for prefix in made.prefixes if prefix.name == PACKAGE]
    if not programs:
        return PACKAGE
    return "" if programs[0].is_file() else PROGRAM


def _holders(found: Build) -> list[Package]:
    return [p for p in found.packages if any(file.stem == _INTERFACE for file in p.interface_files)]


def _generated(made: Build) -> list[Package]:
    """The packages that hold the interface's file and for which something was generated from it."""
    module = f"_{_snake(_INTERFACE)}.py"
    return [
        package
        for package in _holders(made)
        for prefix in made.prefixes
        if prefix.name == package.name and any(prefix.rglob(f"{package.name}/srv/{module}"))
    ]


def _probe(made: Build) -> Sequence[str]:
    package = _generated(made)[0].name
    return [sys.executable, "-m", "autograder.workspaces.probe", f"{package}/srv/{_INTERFACE}", SERVICE]


PLANS = {
    "hello": Plan(
        targets=lambda found: [package.name for package in found.packages if package.name == PACKAGE],
        missing=_hello_missing,
        command=lambda _: [ros2(), "run", PACKAGE, PROGRAM],
    ),
    "interface": Plan(
        targets=lambda found: [package.name for package in _holders(found)],
        missing=lambda made: "" if _generated(made) else INTERFACE_FILE,
        command=_probe,
    ),
}
"""By the name that an exercise gives as its runner; a launch file has no plan, it says itself what it needs."""


def launch_targets(file: Path) -> Callable[[Build], Iterable[str]]:
    """The packages of a workspace whose names stand in a launch file.

    Args:
        file: The launch file, in whatever language.
    """
    words = set(re.findall(r"\w+", file.read_text(encoding="utf-8", errors="replace")))
    return lambda found: [package.name for package in found.packages if package.name in words]


def lacks_programs(file: Path, made: Build, course_build: Build) -> bool:
    """Whether a launch file names programs of the course's package that the student's has not got.

    Who has written talker and listener in the notebooks alone has no programs to launch.
    """
    words = set(re.findall(r"\w+", file.read_text(encoding="utf-8", errors="replace")))
    return bool(words & _programs(course_build) - _programs(made))


def reference_workspace() -> Path:
    """The workspace with the course's own talker and listener."""
    return course.root() / "solutions" / WORKSPACE


def reference_package() -> Path:
    """The package with the course's own talker and listener."""
    return reference_workspace() / "src" / PACKAGE


@functools.cache
def course_interfaces() -> tuple[Path, ...]:
    """All files and folders of the interfaces that come with the course.

    Whoever is to make interfaces must not find these: copied, they would look like generated ones.
    """
    patterns = (
        f"share/{COURSE_PACKAGE}",
        f"include/{COURSE_PACKAGE}",
        f"share/ament_index/resource_index/*/{COURSE_PACKAGE}",
        f"lib/lib{COURSE_PACKAGE}__*.so",
        f"lib/python*/*-packages/{COURSE_PACKAGE}*",
    )
    prefixes = {sys.prefix, *os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep)} - {""}
    return tuple(
        sorted(found for prefix in prefixes for pattern in patterns for found in Path(prefix).glob(pattern))
    )


def ros2() -> str:
    """The ``ros2`` command of this environment."""
    beside = Path(sys.executable).with_name("ros2")
    return str(beside) if beside.exists() else shutil.which("ros2") or "ros2"


def _programs(made: Build) -> set[str]:
    return {program.name for prefix in made.prefixes for program in (prefix / "lib" / prefix.name).glob("*")}


def _snake(name: str) -> str:
    return "".join(f"_{c.lower()}" if c.isupper() and i else c.lower() for i, c in enumerate(name))
