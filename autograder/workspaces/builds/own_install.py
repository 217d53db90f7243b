"""Finds out whether a student's own build (`install`) is up to date with the sources (`src`), and what was changed.

This is decided by comparing two times: when a file's content or name last changed (``st_ctime``), and when the
package's last `colcon build` began. The times can be compared because both come from the same file system, and so from
the same clock; and no program can set ``st_ctime``. Comparing contents instead would not be enough, because `install`
has no copy of setup.py or CMakeLists.txt. But a newer file that equals its installed copy counts as unchanged. For
example, running a cell that writes a program changes the file's time even if the program stays the same.

`colcon` never removes what an earlier build has installed. So an `install` folder may have a module or program that the
sources do not have. Such a folder is not used, because the grader of a class builds from the sources alone and would
not have this module or program. A folder with a launch file that the last build did not install is not used, either,
because `ros2 launch` refuses a name that it finds twice.
"""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

import re2

from autograder.workspaces.builds.install_folder import (
    entry_points,
    is_isolated,
    linked_build,
    programs,
    python_folders,
)
from autograder.workspaces.byte_budget import ByteBudget
from autograder.workspaces.packages import DEFINITIONS, launch_files
from autograder.workspaces.sources import is_source

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence
    from pathlib import Path

    from autograder.workspaces.packages import Package

_MOST_NAMED = 3
"""The maximum number of changed files to name."""
_BEGAN = "colcon_command_prefix_*.sh"
"""A file that colcon writes into a package's build folder when it begins to build the package."""
_RESULT = "colcon_build.rc"
"""The file into which colcon writes the exit code of a package's build."""
_RECORDS = ("install.log", "install_manifest.txt")
"""Files in a package's build folder that list what its last build installed: setuptools' list and CMake's."""
_OPTIMIZED = re2.compile(r"(?m)^CMAKE_BUILD_TYPE:\w+=(?:Release|RelWithDebInfo|MinSizeRel)$")
"""Matches a build type in CMakeCache.txt that defines NDEBUG. Without NDEBUG, a value of the wrong type ends the
process, which does not happen when a class is graded (:func:`autograder.workspaces.builds.colcon.command`).
"""


def is_current(workspace: Path, packages: Sequence[Package]) -> bool:
    """Return True if the last `colcon build` of each package succeeded and is up to date with `src`."""
    return is_isolated(workspace / "install") and all(
        _succeeded(workspace, package)
        and not any(_changed(workspace, package))
        and not any(_left_over(workspace, package))
        for package in packages
    )


def changed_since(workspace: Path, packages: Iterable[Package]) -> str:
    """Return the names of the sources that were changed since the last `colcon build`; empty if there are none.

    A package that was never built has no changed sources.
    """
    names = [
        f"`{file.relative_to(package.folder.parent)}`"
        for package in packages
        for file in _changed(workspace, package)
    ]
    more = [f"{len(names) - _MOST_NAMED} more"] if len(names) > _MOST_NAMED else []
    *others, last = [*names[:_MOST_NAMED], *more] or [""]
    return f"{', '.join(others)} and {last}" if others else last


def _succeeded(workspace: Path, package: Package) -> bool:
    build, prefix = _folders(workspace, package)
    if _text(build / _RESULT).strip() != "0" or not python_folders(prefix):
        return False
    if package.build_type == "ament_python":
        named = {entry.split(" = ")[0] for entry in entry_points(prefix, ByteBudget(sys.maxsize))}
        return named == set(programs(prefix))
    return bool(_OPTIMIZED.search(_text(build / "CMakeCache.txt")))


def _changed(workspace: Path, package: Package) -> Iterator[Path]:
    """Yield the sources of a package that were changed since its last build began."""
    build, prefix = _folders(workspace, package)
    began = max((file.stat().st_mtime_ns for file in build.glob(_BEGAN)), default=None)
    if began is None or not prefix.is_dir():
        return
    linked = _linked(prefix)
    for file in _sources(package):
        if file.stat().st_ctime_ns < began or any(file.is_relative_to(folder) for folder in linked):
            continue
        if not any(_is_copy(copy, file, package.folder) for copy in prefix.rglob("*")):
            yield file


def _left_over(workspace: Path, package: Package) -> Iterator[Path]:
    """Yield the installed files that the package's sources do not contain, or that the last build did not install."""
    build, prefix = _folders(workspace, package)
    recorded = {path for record in _RECORDS for path in _text(build / record).splitlines()}
    launches = [prefix / file for file in launch_files(prefix)]
    yield from (file for file in launches if str(file) not in recorded)
    linked = _linked(prefix)
    # In a copied workspace, the links still lead into the original workspace, so Python would import its modules.
    yield from (folder for folder in linked if not folder.is_relative_to(package.folder))
    modules = [] if linked else [(f, m) for f in python_folders(prefix) for m in f.rglob("*.py")]
    shared = prefix / "share" / package.name
    definitions = [(shared, file) for file in shared.rglob("*") if file.suffix in DEFINITIONS]
    sources = list(_sources(package))
    for folder, file in [*(modules if package.build_type == "ament_python" else ()), *definitions]:
        if not any(_is_copy(source, file, folder) for source in sources):
            yield file


def _linked(prefix: Path) -> list[Path]:
    """Return the source folders to which `--symlink-install` made links, and from which Python imports the modules."""
    build = linked_build(prefix)
    return (
        [entry.resolve() for entry in build.iterdir() if entry.is_symlink() and entry.is_dir()]
        if build
        else []
    )


def _folders(workspace: Path, package: Package) -> tuple[Path, Path]:
    """Return the build folder and the install folder of a package."""
    return workspace / "build" / package.name, workspace / "install" / package.name


def _sources(package: Package) -> Iterator[Path]:
    """Yield the files of a package that a grader would build; links are left out."""
    for file in sorted(package.folder.rglob("*")):
        if (
            is_source(file.relative_to(package.folder).as_posix())
            and file.is_file()
            and not file.is_symlink()
        ):
            yield file


def _is_copy(copy: Path, file: Path, folder: Path) -> bool:
    """Return True if ``copy`` has the bytes of ``file``, and its path ends with the path of ``file`` in ``folder``."""
    inside = file.relative_to(folder).parts
    return copy.parts[-len(inside) :] == inside and copy.is_file() and copy.read_bytes() == file.read_bytes()


def _text(file: Path) -> str:
    return file.read_text(encoding="utf-8", errors="replace") if file.is_file() else ""
