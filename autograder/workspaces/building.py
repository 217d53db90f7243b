"""Build a workspace with colcon, unless the same sources were built before."""

from __future__ import annotations

import os
import re
import shutil
import signal
import subprocess
import sys
import time
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from autograder.workspaces import cache
from autograder.workspaces.failures import telling_line
from autograder.workspaces.packages import BadPackage, Package, find_packages, key
from autograder.workspaces.prefixes import package_prefixes, without_workspaces

if TYPE_CHECKING:
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


def build(workspace: Path) -> Build:
    """Build the packages in a workspace's ``src``, each time as if for the first time.

    The result is in the cache, not in the workspace: what an earlier build left in ``install`` has no part in
    it.
    The workspace is not written to.

    Args:
        workspace: The folder that holds ``src``.
    """
    began = time.monotonic()
    found = look(workspace)
    if found.trouble:
        return found
    workspace, packages = found.workspace, found.packages
    try:
        sources = key(workspace / "src")
    except BadPackage as error:
        return replace(found, trouble="bad_package", line=str(error))
    with cache.entry(sources) as entry:
        install = entry.folder / "install"
        if entry.complete:
            seconds = time.monotonic() - began
            return Build(workspace, True, install, packages, seconds, reused=True)
        log = _colcon(workspace, entry.folder)
        seconds = time.monotonic() - began
        if log is None:
            shutil.rmtree(entry.folder / "build", ignore_errors=True)
            entry.finish()
            return Build(workspace, True, install, packages, seconds)
    failed = _FAILED.search(log)
    name = failed["name"] if failed else ""
    own = _log_of(log, name)
    # What setup.py itself says when colcon first asks it goes past the package's part of the log.
    own = log if "CalledProcessError" in telling_line(own) else own
    return Build(
        workspace, False, None, packages, seconds,
        trouble="build", package=name, line=telling_line(own), log=own[-MAX_LOG:],
    )  # fmt: skip


def look(workspace: Path) -> Build:
    """What is there to be built, without building it.

    Args:
        workspace: The folder that holds ``src``.
    """
    workspace = workspace.resolve()
    src = workspace / "src"
    if not src.is_dir():
        return Build(workspace, ok=False, trouble="no_workspace", line=_no_workspace(workspace))
    try:
        packages = tuple(find_packages(src))
    except BadPackage as error:
        return Build(workspace, ok=False, trouble="bad_package", line=str(error))
    if not packages:
        return Build(workspace, ok=False, trouble="no_package", line=f"there is no package.xml below {src}")
    return Build(workspace, ok=False, packages=packages)


def command(src: Path, build_base: Path, install: Path, log_base: Path) -> list[str]:
    """Colcon's command line.

    Release defines NDEBUG: without it a value of the wrong type in a field of a generated message ends the
    whole
    process with SIGABRT instead of raising an exception.
    """
    return [
        sys.executable, "-m", "colcon", "--log-base", str(log_base),
        "build", "--base-paths", str(src), "--build-base", str(build_base), "--install-base", str(install),
        "--event-handlers", "console_cohesion+", "console_start_end+", "desktop_notification-", "status-",
        "--cmake-args", f"-DPython3_EXECUTABLE={sys.executable}", "-DCMAKE_BUILD_TYPE=Release",
        "-DBUILD_TESTING=OFF", "--no-warn-unused-cli", "-Wno-dev",
    ]  # fmt: skip


def _colcon(workspace: Path, folder: Path) -> str | None:
    """Run colcon; its output where it failed, else None."""
    environment = without_workspaces(os.environ, workspace)
    environment.pop("PYTHONDONTWRITEBYTECODE", None)  # setuptools warns of it in every log
    environment["COLCON_DEFAULTS_FILE"] = os.devnull
    process = subprocess.Popen(
        command(workspace / "src", folder / "build", folder / "install", folder / "log"),
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
