"""Adds the programs of Lab 1.2 to a student's package, for later labs whose launch files start them.

A launch file starts the programs of packages. If a student wrote the nodes of Lab 1.2 only in the notebook, a later
exercise about launch files would fail with "executable not found".
"""

from __future__ import annotations

import re  # noqa: TID251  (in the student's own kernel)
import shutil
from pathlib import Path

from autograder import course
from autograder.notebook.package_files import PACKAGE, add_entry_points

PROGRAMS = ("talker", "listener")

_CLASS = re.compile(r"^class ", re.MULTILINE)


def complete_package(workspace: str | Path = "ros2_ws", source: Path | None = None) -> str:
    """Put the course's talker and listener into the student's package if they are missing.

    Code that a student has written stays as it is; only entry points are added to ``setup.py``. A second call changes
    nothing.

    Args:
        workspace: The workspace folder, which contains ``src``; it is created if it does not exist.
        source: The package to copy from; by default the course's own.

    Returns:
        One or two sentences that say what was done, or what the student has to do.
    """
    package = Path(workspace) / "src" / PACKAGE
    try:
        source = source or course.root() / course.SOLUTIONS / "ros2_ws" / "src" / PACKAGE
    except course.NoCourse:  # the sandbox of a submission sees no course folder
        return "This notebook is graded alone: if your package lacks a program, the check takes the course's own."
    if not source.is_dir():  # students' copy of the course contains no solutions
        return _what_is_missing(package)
    if not (package / "package.xml").is_file():
        shutil.copytree(source, package, dirs_exist_ok=True)
        return f"There was no {PACKAGE} in {workspace}. The course's own has been put there."
    missing = [name for name in PROGRAMS if not _has_program(package, name)]
    if not missing:
        return f"Your {PACKAGE} has the programs {' and '.join(PROGRAMS)}. Nothing was changed."
    return _add(missing, package, source)


def _what_is_missing(package: Path) -> str:
    missing = [name for name in PROGRAMS if not _has_program(package, name)]
    if not missing:
        return f"Your {PACKAGE} has the programs {' and '.join(PROGRAMS)}."
    return (
        f"{package} has no program {' and no program '.join(missing)} yet. "
        "Do Lab 1.2 first: its nodes become the programs of this package that are launched here."
    )


def _has_program(package: Path, name: str) -> bool:
    setup = package / "setup.py"
    text = setup.read_text(encoding="utf-8", errors="replace") if setup.is_file() else ""
    declared = re.search(rf"""^[^#\n]*["']\s*{name}\s*=""", text, re.MULTILINE) is not None
    return declared and not _is_empty(package / PACKAGE / f"{name}.py")


def _is_empty(module: Path) -> bool:
    """Return True if a module contains no class. Lab 1.2's cell writes such a module if it copies no class into it."""
    return module.is_file() and not _CLASS.search(module.read_text(encoding="utf-8", errors="replace"))


def _add(missing: list[str], package: Path, source: Path) -> str:
    entries = [f"{name} = {PACKAGE}.{name}:main" for name in missing]
    said = add_entry_points(package.parents[1], entries)
    if not said.startswith("Executables"):
        return said
    for name in missing:
        module = package / PACKAGE / f"{name}.py"
        if not module.exists() or _is_empty(module):
            module.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(source / PACKAGE / f"{name}.py", module)
    return f"Added to your {PACKAGE}: {' and '.join(missing)}."
