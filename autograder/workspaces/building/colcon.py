"""What is there to be built, how colcon is told to build it, and what its output says of a failure."""

from __future__ import annotations

import sys
from dataclasses import replace
from typing import TYPE_CHECKING

import re2

from autograder.workspaces.building.failures import telling_line
from autograder.workspaces.building.result import Build
from autograder.workspaces.sources.packages import needed, survey

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from pathlib import Path

    from autograder.workspaces.building.result import Targets
    from autograder.workspaces.sources.packages import Package

MAX_LOG = 40_000
"""Characters of a failed build's log that are kept: its end."""
_FAILED = re2.compile(r"(?m)^Failed\s+<<< (?P<name>\S+)")


def failed(found: Build, log: str) -> Build:
    """A workspace that could not be built, with what colcon's output tells of it."""
    search = _FAILED.search(log)
    name = search["name"] if search else ""
    own = _log_of(log, name)
    # What setup.py itself says when colcon first asks it goes past the package's part of the log.
    own = log if "CalledProcessError" in telling_line(own) else own
    return replace(found, trouble="build", package=name, line=telling_line(own), log=own[-MAX_LOG:])


def look(workspace: Path) -> Build:
    """What is there to be built, without building it.

    Args:
        workspace: The folder that holds ``src``.
    """
    workspace = workspace.resolve()
    src = workspace / "src"
    if not src.is_dir():
        return Build(workspace, ok=False, trouble="no_workspace", line=_no_workspace(workspace))
    packages, unusable = survey(src)
    found = Build(workspace, ok=False, packages=tuple(packages), unusable=tuple(unusable))
    if packages:
        return found
    if unusable:
        return replace(found, trouble="bad_package", line=unusable[0])
    return replace(found, trouble="no_package", line=f"there is no package.xml below {src}")


def choose(found: Build, targets: Targets | None) -> tuple[list[Package], Build]:
    """The packages that are to be built, and the workspace with its trouble where these cannot be.

    A package that is not needed, half done or not usable at all, hurts nobody.
    """
    chosen = needed(found.packages, targets(found)) if targets is not None else []
    if chosen or not found.unusable:
        return chosen or list(found.packages), found
    return [], replace(found, trouble="bad_package", line=found.unusable[0])


def moved(packages: Iterable[Package], src: Path, there: Path) -> list[Package]:
    """The packages as they are found where their sources are written again.

    Args:
        packages: The packages.
        src: The folder that they are in.
        there: The other folder.
    """
    return [replace(package, folder=there / package.folder.relative_to(src)) for package in packages]


def command(packages: Iterable[Package], folder: Path, cmake: Sequence[str] = ()) -> list[str]:
    """Colcon's command line for these packages alone; ``build``, ``install`` and ``log`` come into the folder.

    Args:
        packages: The packages.
        folder: Where all that is made comes to.
        cmake: More arguments for CMake.

    Release defines NDEBUG: without it a value of the wrong type in a field of a generated message ends the whole
    process with SIGABRT instead of raising an exception.
    """
    return [
        sys.executable, "-m", "colcon", "--log-base", str(folder / "log"),
        "build", "--paths", *(str(package.folder) for package in packages),
        "--build-base", str(folder / "build"), "--install-base", str(folder / "install"),
        "--event-handlers", "console_cohesion+", "console_start_end+", "desktop_notification-", "status-",
        "--cmake-args", f"-DPython3_EXECUTABLE={sys.executable}", "-DCMAKE_BUILD_TYPE=Release",
        "-DBUILD_TESTING=OFF", "--no-warn-unused-cli", "-Wno-dev", *cmake,
    ]  # fmt: skip


def _log_of(log: str, package: str) -> str:
    """The part of colcon's output that belongs to one package, else all of it."""
    if package:
        found = re2.search(rf"(?ms)^--- output: {re2.escape(package)}\n(.*?)^---$", log)
        if found:
            return found[1]
    return log


def _no_workspace(workspace: Path) -> str:
    if not workspace.exists():
        return f"there is no folder {workspace}"
    if (workspace / "package.xml").is_file():
        return f"{workspace} is a package: name the workspace, the folder that holds src"
    return f"{workspace} has no folder src"
