"""Describes a workspace before and after its build, makes colcon's command line, and finds why a build failed.

The reason for a failed build is the line of colcon's output that explains the failure best. A build in the cache can be
copied into the workspace, where terminals find it.
"""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import re2

from autograder.safe_files import scratch_folder
from autograder.workspaces.builds.install_folder import (
    entry_points,
    is_merged,
    package_prefixes,
    programs,
    rename_paths,
)
from autograder.workspaces.packages import find_packages, launch_files, needed
from course_runtime.python_child import INTERPRETER, python_child

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from autograder.workspaces.packages import Package
    from autograder.workspaces.sources import ByteBudget


@dataclass(frozen=True)
class Build:
    """A workspace: the packages in it, and the result of building them.

    Attributes:
        workspace: The folder of the workspace.
        ok: True if every package was built.
        install: The folder of the installed packages; None if the build failed.
        packages: The packages of the workspace, as their files describe them.
        unusable: For each package that cannot be used, a sentence with the reason.
        seconds: The duration of the build in seconds of wall time.
        reused: True if the build was already in the cache.
        trouble: The kind of failure: ``"no_workspace"``, ``"no_package"``, ``"bad_package"``, ``"entry_point"`` or
            ``"build"``; empty if there is none.
        package: The name of the package that failed; empty if none did.
        line: The line of the log that explains the failure best.
        log: The log of the failed build.
        changed: The sources that the student has changed since the last `colcon build`, in words.
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
    changed: str = ""

    @property
    def prefixes(self) -> list[Path]:
        """The install folder (prefix) of each package of this build."""
        return package_prefixes(self.install) if self.install else []

    def programs(self, package: str) -> tuple[str, ...]:
        """Return the names of the programs that ``ros2 run`` finds in an installed package; empty if there are none."""
        return tuple(p for prefix in self.prefixes if prefix.name == package for p in programs(prefix))

    def launch_files(self, package: str) -> tuple[Path, ...]:
        """Return the launch files that a package has installed, as paths below the package's prefix."""
        return tuple(f for prefix in self.prefixes if prefix.name == package for f in launch_files(prefix))

    def entry_points(self, package: str, budget: ByteBudget) -> tuple[str, ...]:
        """Return the entry points of an installed Python package, as ``name = module:function``."""
        return tuple(
            e for prefix in self.prefixes if prefix.name == package for e in entry_points(prefix, budget)
        )


Targets = Callable[[Build], Iterable[str]]
"""A function that returns the names of the needed packages of a workspace. An empty result means all packages."""


def describe_workspace(workspace: Path) -> Build:
    """Return the description of a workspace that is not built: its packages, or why it has no usable package.

    Args:
        workspace: The workspace folder, which contains ``src``.
    """
    workspace = workspace.resolve()
    src = workspace / "src"
    if not src.is_dir():
        return Build(workspace, ok=False, trouble="no_workspace", line=_no_workspace(workspace))
    packages, unusable = find_packages(src)
    found = Build(workspace, ok=False, packages=tuple(packages), unusable=tuple(unusable))
    if packages:
        return found
    if unusable:
        return replace(found, trouble="bad_package", line=unusable[0])
    return replace(found, trouble="no_package", line=f"there is no package.xml below {src}")


def _no_workspace(workspace: Path) -> str:
    if not workspace.exists():
        return f"there is no folder {workspace}"
    if (workspace / "package.xml").is_file():
        return f"{workspace} is a package: name the workspace, the folder that holds src"
    return f"{workspace} has no folder src"


def packages_to_build(found: Build, targets: Targets | None) -> tuple[list[Package], Build]:
    """Return the packages to build, and the description of the workspace.

    The packages to build are the targets that the workspace contains, and the packages on which these depend. If the
    workspace contains no target, all its packages have to be built. In that case, one unusable package is enough for
    the build to fail: no packages are returned, and the description contains the ``trouble``.
    """
    chosen = needed(found.packages, targets(found)) if targets is not None else []
    if chosen or not found.unusable:
        return chosen or list(found.packages), found
    return [], replace(found, trouble="bad_package", line=found.unusable[0])


def moved_packages(packages: Iterable[Package], src: Path, there: Path) -> list[Package]:
    """Return copies of the packages, with the paths that they have when their sources are in another folder.

    Args:
        src: The folder that contains the packages now.
        there: The folder in which the sources will be.
    """
    return [replace(package, folder=there / package.folder.relative_to(src)) for package in packages]


def colcon_command(packages: Iterable[Package], folder: Path, cmake: Sequence[str] = ()) -> list[str]:
    """Return the command with which colcon builds only these packages.

    Args:
        folder: The folder in which colcon makes ``build``, ``install`` and ``log``.
        cmake: More arguments for CMake.

    The build type is Release because it defines NDEBUG. Without NDEBUG, a value of the wrong type in a field of a
    generated message would end the process with SIGABRT instead of raising an exception.
    """
    words = [
        "-m", "colcon", "--log-base", str(folder / "log"),
        "build", "--paths", *(str(package.folder) for package in packages),
        "--build-base", str(folder / "build"), "--install-base", str(folder / "install"),
        "--event-handlers", "console_cohesion+", "console_start_end+", "desktop_notification-", "status-",
        "--cmake-args", f"-DPython3_EXECUTABLE={INTERPRETER}", "-DCMAKE_BUILD_TYPE=Release",
        "-DBUILD_TESTING=OFF", "--no-warn-unused-cli", "-Wno-dev", *cmake,
    ]  # fmt: skip
    return python_child(*words).command


class CannotCopyBuild(RuntimeError):
    """A build cannot be copied into the workspace's install folder. The exception's text says what to do."""


def copy_to_workspace(made: Build) -> Path:
    """Copy a build from the cache into the workspace's ``install`` folder, so that terminals can source it.

    Packages of the build replace earlier builds of the same packages; other packages stay. Files are replaced and not
    overwritten, so that a running program keeps the libraries that it has loaded.

    Returns:
        The install folder.

    Raises:
        ValueError: The build failed.
        CannotCopyBuild: The folder was made with ``--merge-install``, or is not writable.
    """
    if made.install is None:
        raise ValueError("a build that failed cannot be copied")
    target = made.workspace / "install"
    if is_merged(target):
        raise CannotCopyBuild(f"{target} was built with --merge-install: delete it, and build again")
    try:
        target.mkdir(exist_ok=True)
        with scratch_folder(target, ".new-") as fresh:
            # Copy first, so that an error while copying leaves the earlier builds as they are; into the same file
            # system, so that a rename moves each package to its place.
            copied = fresh / "install"
            shutil.copytree(made.install, copied, symlinks=True, ignore=shutil.ignore_patterns("__pycache__"))
            rename_paths(copied, str(made.install), str(target))
            for entry in sorted(copied.iterdir()):
                old = target / entry.name
                if old.is_dir() and not old.is_symlink():
                    shutil.rmtree(old)
                entry.replace(old)
    except OSError as error:
        raise CannotCopyBuild(f"{target} cannot be written: {error.strerror}") from error
    return target


MAX_LOG = 40_000
"""The maximum number of characters to keep from the end of a failed build's log."""
_REFUSED = "setup()' was never called"
"""The last line of a build's output contains this text if setuptools rejects an argument in setup.py, without giving
the reason.
"""
_WHAT_REFUSED = (
    "setuptools refuses setup.py; `python3 setup.py --version`, in the folder of the package, says why"
)
_FAILED = re2.compile(r"(?m)^Failed\s+<<< (?P<name>\S+)")


def failed_build(found: Build, log: str) -> Build:
    """Return the description of a failed build, with the reason from colcon's output (``log``)."""
    search = _FAILED.search(log)
    name = search["name"] if search else ""
    own = _log_of(log, name)
    # Use the whole log if setup.py fails when colcon asks for its metadata, because the error is then not in the
    # package's part of the log.
    own = log if "CalledProcessError" in _telling_line(own) else own
    made = replace(found, trouble="build", package=name, line=_telling_line(own), log=own[-MAX_LOG:])
    if _REFUSED not in made.line:
        return made
    bad = next((package.bad_entry_point for package in found.packages if package.name == name), "")
    return replace(made, trouble="entry_point", line=bad) if bad else replace(made, line=_WHAT_REFUSED)


def _log_of(log: str, package: str) -> str:
    """Return the part of colcon's output that is about one package; the whole output if it has no such part."""
    if package:
        found = re2.search(rf"(?ms)^--- output: {re2.escape(package)}\n(.*?)^---$", log)
        if found:
            return found[1]
    return log


MAX_CMAKE_ERROR = 240
"""The maximum number of characters to quote of an error of CMake."""
_COMPILER = re2.compile(
    r"(?m)^(?P<file>[^\s:][^:\n]*):(?P<line>\d+):(?:\d+:)? (?:fatal )?error: (?P<what>.*)$"
)
_CMAKE = re2.compile(
    r"(?m)^CMake Error at (?P<file>[^:\n]+):(?P<line>\d+)[^\n]*:\n+(?P<what>[ \t]+\S.*(?:\n[ \t]+\S.*|\n\n  \S.*)*)"
)
_CMAKE_STATUS = re2.compile(r"(?m)^-- .*\n?")
_CALL_STACK = re2.compile(r"\n+Call Stack \(most recent call first\):(?P<calls>(?:\n[ \t]+\S.*)+)")
_CALL = re2.compile(r"^(?P<file>[^:\n]+):(?P<line>\d+)")
_CMAKE_PLAIN = re2.compile(r"(?m)^CMake Error: (?P<what>.*)$")
_PYTHON = re2.compile(r"(?m)^(?P<what>(?:[\w.]*(?:Error|Exception|Invalid\w+)|[\w.]+\.[A-Z]\w+)(?::.*)?)$")
_PLACE = re2.compile(r'(?m)^\s*File "(?P<file>[^"]+)", line (?P<line>\d+)')
_LIBRARIES = ("site-packages", "/lib/python3")
"""Parts of the paths of Python's own modules and of installed packages, which are never the cause of a failed build."""
_SETUPTOOLS = re2.compile(r"(?m)^error: (?P<what>.*)$")
_NINJA_MAKE = re2.compile(r"^(?:make|gmake|ninja|---|<<<|>>>)")


def _telling_line(log: str) -> str:
    """Return the line of colcon's output that explains best why a build failed; empty only if there is no output.

    The line begins with the file and the line number if the output contains them.
    """
    if found := _COMPILER.search(log):
        return f"{_short(found['file'])}:{found['line']}: {found['what']}"
    python = _python(log)
    # Remove CMake's status lines, because they come from another stream and may appear between the lines of an error.
    log = _CMAKE_STATUS.sub("", log) or log
    if found := _CMAKE.search(log):
        # If CMake reports that a Python program that it called has failed, the cause is the error in that program.
        if python and "execute_process" in found["what"]:
            return python
        what = " ".join(found["what"].split())
        what = what if len(what) <= MAX_CMAKE_ERROR else what[: what.rfind(" ", 0, MAX_CMAKE_ERROR)] + " …"
        return f"{_place(found, log)}: {what}"
    if found := _CMAKE_PLAIN.search(log):
        return found["what"].strip()
    if python:
        return python
    if found := _SETUPTOOLS.search(log):
        return found["what"].strip()
    lines = [line.strip() for line in log.splitlines() if line.strip() and not _NINJA_MAKE.match(line)]
    return lines[-1] if lines else ""


def _python(log: str) -> str:
    """Return the last error of Python, with the student's file and line; empty if the output has no such error."""
    # CalledProcessError only means that a program that colcon or CMake called has failed, so look for that program's
    # error.
    found = list(_PYTHON.finditer(log))
    errors = [error for error in found if "CalledProcessError" not in error["what"]] or found
    if not errors:
        return ""
    error = errors[-1]
    places = [
        place
        for place in _PLACE.finditer(log, 0, error.start())
        if not any(part in place["file"] for part in _LIBRARIES) and not place["file"].startswith("<frozen")
    ]
    if not places:
        return error["what"].strip()
    file, line = places[-1]["file"], places[-1]["line"]
    # setuptools executes setup.py as a text, so tracebacks call the file "<string>".
    file = "setup.py" if file == "<string>" and "run_setup" in log else file
    return f"{_short(file)}:{line}: {error['what'].strip()}"


def _place(error: re2.Match[str], log: str) -> str:
    """Return the package's file and line that caused a CMake error, even if CMake names a library's file."""
    stack = _CALL_STACK.match(log, error.end())
    own = _CALL.search(stack["calls"].strip().splitlines()[-1].strip()) if stack else None
    place = own or error
    return f"{_short(place['file'])}:{place['line']}"


def _short(file: str) -> str:
    """Return the last two parts of a path: the package and the file."""
    return "/".join(file.split("/")[-2:])
