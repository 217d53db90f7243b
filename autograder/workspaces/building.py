"""Build a workspace with colcon, unless the same sources were built before."""

from __future__ import annotations

import os
import re
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from autograder.workspaces import cache, door
from autograder.workspaces.failures import telling_line
from autograder.workspaces.packages import BadPackage, Package, key, needed, survey
from autograder.workspaces.prefixes import package_prefixes, without_workspaces

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

LIMIT = 300.0
"""Seconds of wall time in which colcon must have ended."""
MAX_LOG = 40_000
"""Characters of a failed build's log that are kept: its end."""
_FAILED = re.compile(r"^Failed\s+<<< (?P<name>\S+)", re.MULTILINE)


@dataclass(frozen=True)
class Build:
    """What building a workspace brought.

    Attributes:
        workspace: Its folder.
        ok: Whether every package was built.
        install: Where the packages are installed; empty where it failed.
        packages: The packages of the workspace, as their files describe them.
        unusable: What is wrong with those that cannot be used.
        seconds: Wall time that it took.
        reused: Whether the same sources had been built before.
        trouble: ``"no_workspace"``, ``"no_package"``, ``"bad_package"`` or ``"build"``; empty where it is
            well.
        package: The package that failed, else empty.
        line: The one line that matters of a failure.
        log: The log of a failure.
    """

    workspace: Path
    ok: bool
    install: Path | None = None
    packages: tuple[Package, ...] = ()
    unusable: tuple[str, ...] = ()
    seconds: float = 0.0
    reused: bool = False
    trouble: str = ""
    package: str = ""
    line: str = ""
    log: str = field(default="", repr=False)

    @property
    def prefixes(self) -> list[Path]:
        """One folder for each installed package."""
        return package_prefixes(self.install) if self.install else []


Targets = Callable[[Build], Iterable[str]]
"""Says of a workspace that was looked at which of its packages are needed; none of them means all."""


def build(workspace: Path, targets: Targets | None = None) -> Build:
    """Build packages in a workspace's ``src``, each time as if for the first time.

    The result is in the cache, not in the workspace: what an earlier build left in ``install`` has no part in
    it.
    The workspace is not written to.

    Args:
        workspace: The folder that holds ``src``.
        targets: Which packages are needed; they are built with what they depend on. None for all.
    """
    began = time.monotonic()
    found = look(workspace)
    if found.trouble:
        return found
    chosen, found = choose(found, targets)
    if found.trouble:
        return found
    workspace = found.workspace
    try:
        sources = key(workspace / "src", chosen)
    except BadPackage as error:
        return replace(found, trouble="bad_package", line=str(error))
    with cache.entry(sources) as entry:
        install = entry.folder / "install"
        if entry.complete:
            return replace(found, ok=True, install=install, seconds=time.monotonic() - began, reused=True)
        graders = door.ask(found, chosen, install)
        if graders is not None:
            if graders.ok:
                entry.finish()
            return graders
        log = _colcon(workspace, chosen, entry.folder)
        if log is None:
            shutil.rmtree(entry.folder / "build", ignore_errors=True)
            entry.finish()
            return replace(found, ok=True, install=install, seconds=time.monotonic() - began)
    return failed(replace(found, seconds=time.monotonic() - began), log)


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


def command(packages: Iterable[Package], folder: Path, cmake: Sequence[str] = ()) -> list[str]:
    """Colcon's command line for these packages alone; ``build``, ``install`` and ``log`` come into the folder.

    Args:
        packages: The packages.
        folder: Where all that is made comes to.
        cmake: More arguments for CMake.

    Release defines NDEBUG: without it a value of the wrong type in a field of a generated message ends the
    whole
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


def _colcon(workspace: Path, packages: Sequence[Package], folder: Path) -> str | None:
    """Run colcon; its output where it failed, else None."""
    environment = without_workspaces(os.environ, workspace)
    environment.pop("PYTHONDONTWRITEBYTECODE", None)  # setuptools warns of it in every log
    environment["COLCON_DEFAULTS_FILE"] = os.devnull
    process = subprocess.Popen(
        command(packages, folder),
        cwd=folder,
        env=environment,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors="replace",
        start_new_session=True,
    )
    try:
        output, _ = process.communicate(timeout=LIMIT)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        output, _ = process.communicate()
        return f"{output}\nerror: the build did not end within {LIMIT:g} s"
    except BaseException:
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        raise
    return None if process.returncode == 0 else output


def _log_of(log: str, package: str) -> str:
    """The part of colcon's output that belongs to one package, else all of it."""
    if package:
        found = re.search(rf"^--- output: {re.escape(package)}\n(.*?)^---$", log, re.MULTILINE | re.DOTALL)
        if found:
            return found[1]
    return log


def _no_workspace(workspace: Path) -> str:
    if not workspace.exists():
        return f"there is no folder {workspace}"
    if (workspace / "package.xml").is_file():
        return f"{workspace} is a package: name the workspace, the folder that holds src"
    return f"{workspace} has no folder src"
