"""The programs of Lab 1.2 in a student's own package, for the notebooks that start them.

A launch file starts programs of packages. A student who has written the nodes in the notebook only would meet
"executable not found" in an exercise about something else.
"""

from __future__ import annotations

import os
import re
import shutil
from pathlib import Path

from autograder import course
from autograder.workspaces.finding import PACKAGE_VARIABLE

PACKAGE = "my_robot_pkg"
PROGRAMS = ("talker", "listener")

_LIST_OF_PROGRAMS = re.compile(r"""(["'])console_scripts\1\s*:\s*\[""")


def complete_package(workspace: str | Path = "ros2_ws", source: Path | None = None) -> str:
    """Put the course's talker and listener into the student's package where these are missing.

    Nothing that a student has written is changed, but for the entry points that are added to ``setup.py``.
    Running it again changes nothing.

    Args:
        workspace: The folder that holds ``src``; it is made where it is not there.
        source: The package to take things from; the course's own by default.

    Returns:
        What was done, or what the student has to do, in one or two sentences.
    """
    source = source or _courses_own()
    package = Path(workspace) / "src" / PACKAGE
    if not (package / "package.xml").is_file():
        shutil.copytree(source, package, dirs_exist_ok=True)
        return f"There was no {PACKAGE} in {workspace}. The course's own has been put there."
    missing = [name for name in PROGRAMS if not _has_program(package / "setup.py", name)]
    if not missing:
        return f"Your {PACKAGE} has the programs {' and '.join(PROGRAMS)}. Nothing was changed."
    return _add(missing, package, source)


def _courses_own() -> Path:
    handed_out = os.environ.get(PACKAGE_VARIABLE)
    return Path(handed_out) if handed_out else course.root() / "solutions" / "ros2_ws" / "src" / PACKAGE


def _has_program(setup: Path, name: str) -> bool:
    text = setup.read_text(encoding="utf-8") if setup.is_file() else ""
    return re.search(rf"""^[^#\n]*["']\s*{name}\s*=""", text, re.MULTILINE) is not None


def _add(missing: list[str], package: Path, source: Path) -> str:
    setup = package / "setup.py"
    text = setup.read_text(encoding="utf-8") if setup.is_file() else ""
    place = _LIST_OF_PROGRAMS.search(text)
    entries = [f'"{name} = {PACKAGE}.{name}:main",' for name in missing]
    if place is None:
        wanted = " ".join(entries)
        return f"{setup} has no list of console_scripts. Give it one (Lab 1.1, step 2), with: {wanted}"
    for name in missing:
        module = package / PACKAGE / f"{name}.py"
        if not module.exists():
            module.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(source / PACKAGE / f"{name}.py", module)
    lines = "".join(f"\n            {entry}" for entry in entries)
    setup.write_text(text[: place.end()] + lines + text[place.end() :], encoding="utf-8")
    return f"Added to your {PACKAGE}: {' and '.join(missing)}."
