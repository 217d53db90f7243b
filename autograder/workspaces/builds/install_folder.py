"""A colcon install folder: its layout, and the environment in which programs find its packages.

The environment is the one that ``source install/setup.bash`` would make. It is computed here instead, because sourcing
needs a shell, half a second, and a path without spaces.
"""

from __future__ import annotations

import os
import shutil
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import re2

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from autograder.workspaces.sources import ByteBudget

LIBRARY = f"lib/python{sys.version_info.major}.{sys.version_info.minor}/site-packages"
BESIDE = ("build", "log")
"""The folders that colcon makes next to ``install``: for its next build, and with logs for people to read."""
_LAYOUT = ".colcon_install_layout"
_INDEX = "share/ament_index/resource_index"


def package_prefixes(install: Path) -> list[Path]:
    """Return the prefix of each package in an install folder, sorted by package name."""
    if not install.is_dir():
        return []
    return sorted(folder for folder in install.iterdir() if (folder / "share").is_dir())


def is_merged(install: Path) -> bool:
    """Return True if colcon made an install folder with `--merge-install`: all packages have one prefix."""
    layout = install / _LAYOUT
    return layout.is_file() and layout.read_text(encoding="utf-8").strip() != "isolated"


def python_folders(prefix: Path) -> list[Path]:
    """Return the folders of a prefix from which Python imports."""
    return [*_libraries(prefix), *filter(None, [linked_build(prefix)])]


def linked_build(prefix: Path) -> Path | None:
    """Return the build folder from which Python imports a package; None unless `--symlink-install` installed it.

    The path is computed from the names of the folders. It is not read from the link in the prefix, because in a
    submission that link could lead anywhere.
    """
    build = prefix.parent.parent / BESIDE[0] / prefix.name
    linked = any(any(folder.glob("*.egg-link")) for folder in _libraries(prefix))
    return build if linked and build.is_dir() else None


def _libraries(prefix: Path) -> list[Path]:
    # Debian's Python installs into dist-packages when a prefix is given.
    candidates = [prefix / LIBRARY, prefix / "local" / LIBRARY.replace("site-", "dist-")]
    return [folder for folder in candidates if folder.is_dir()]


def programs(prefix: Path) -> list[str]:
    """Return the names of the programs that ``ros2 run`` finds in the package of a prefix."""
    return sorted(file.name for file in (prefix / "lib" / prefix.name).glob("*") if file.is_file())


def entry_points(prefix: Path, budget: ByteBudget) -> Iterator[str]:
    """Yield the entry points of the Python package in a prefix, as ``name = module:function``, up to the byte limit."""
    files = (file for folder in python_folders(prefix) for file in folder.glob("*/entry_points.txt"))
    for file in filter(budget.has, files):
        for line in file.read_text(encoding="utf-8", errors="replace").splitlines():
            if re2.fullmatch(r"\S+ = [\w.]+:[\w.]+", line):
                yield line


def has_service(prefix: Path, interface: str) -> bool:
    """Return True if the package in a prefix has the Python module of a service type.

    Args:
        interface: The name of the type, such as ``"AddTwoInts"``.
    """
    words = (f"_{c.lower()}" if c.isupper() and i else c.lower() for i, c in enumerate(interface))
    return any(prefix.rglob(f"{prefix.name}/srv/_{''.join(words)}.py"))


def is_indexed(prefix: Path) -> bool:
    """Return True if ament finds the package in a prefix."""
    return (prefix / _INDEX / "packages" / prefix.name).is_file()


def files_of_interfaces(prefix: Path, package: str) -> Iterator[Path]:
    """Yield all files and folders of an interface package in a prefix, which may also contain other packages."""
    for pattern in (
        f"share/{package}",
        f"include/{package}",
        f"{_INDEX}/*/{package}",
        f"lib/lib{package}__*.so",
        f"lib/python*/*-packages/{package}*",
    ):
        yield from prefix.glob(pattern)


def with_prefixes(
    environment: Mapping[str, str], prefixes: Iterable[Path], *, last: bool = False
) -> dict[str, str]:
    """Return an environment in which programs find the packages in these prefixes.

    Args:
        environment: The environment to begin with.
        prefixes: The prefixes, one for each package.
        last: True if packages that are already in the environment take precedence.
    """
    chosen = list(prefixes)
    additions = {
        "AMENT_PREFIX_PATH": [prefix for prefix in chosen if (prefix / "share" / "ament_index").is_dir()],
        "CMAKE_PREFIX_PATH": chosen,
        "LD_LIBRARY_PATH": [prefix / "lib" for prefix in chosen if any((prefix / "lib").glob("*.so*"))],
        "PATH": [prefix / "bin" for prefix in chosen if (prefix / "bin").is_dir()],
        "PYTHONPATH": [folder for prefix in chosen for folder in python_folders(prefix)],
    }
    result = dict(environment)
    for name, folders in additions.items():
        there = [part for part in environment.get(name, "").split(os.pathsep) if part]
        ours = [str(folder) for folder in folders if str(folder) not in there or not last]
        # Name each folder only once, because the first occurrence would decide which package takes precedence.
        there = [part for part in there if part not in ours]
        if joined := [*there, *ours] if last else [*ours, *there]:
            result[name] = os.pathsep.join(joined)
    return result


def relocated(environment: Mapping[str, str], here: Path, there: Path) -> dict[str, str]:
    """Return the environment with the path ``here`` replaced by ``there``, at which a process sees the same folder."""
    old, new = f"{here}{os.sep}", f"{there}{os.sep}"
    return {
        name: os.pathsep.join(
            part.replace(old, new, 1) if part.startswith(old) else part for part in value.split(os.pathsep)
        )
        if old in value
        else value
        for name, value in environment.items()
    }


def without_workspaces(environment: Mapping[str, str], workspace: Path) -> dict[str, str]:
    """Return the environment without paths inside a workspace, so that a build does not use an earlier build."""
    result = dict(environment)
    inside = f"{workspace.resolve()}{os.sep}"
    for name in (
        "AMENT_PREFIX_PATH",
        "CMAKE_PREFIX_PATH",
        "COLCON_PREFIX_PATH",
        "LD_LIBRARY_PATH",
        "PYTHONPATH",
    ):
        if name in result:
            parts = result[name].split(os.pathsep)
            result[name] = os.pathsep.join(part for part in parts if not f"{part}{os.sep}".startswith(inside))
    return result


def merge_prefixes(lent: Iterable[Path], own: Iterable[Path], install: Path) -> None:
    """Copy the course's prefixes (``lent``) into a new install folder, and add the student's files (``own``).

    If both have a file with the same path, the course's file is used in ``lib`` (programs and modules), and the
    student's file is used everywhere else.
    """
    students = {prefix.name: prefix for prefix in own}
    for prefix in lent:
        target = install / prefix.name
        layers = [(prefix, target), (prefix / "lib", target / "lib")]
        if prefix.name in students:
            layers.insert(1, (students[prefix.name], target))
        for layer, there in layers:
            shutil.copytree(layer, there, ignore_dangling_symlinks=True, dirs_exist_ok=True)


def rename_paths(folder: Path, old: str, new: str) -> None:
    """Replace a path by another path in all text files of a folder, such as setup scripts and CMake files."""
    for root, _, names in os.walk(folder):
        for file in (Path(root, name) for name in names):
            content = file.read_bytes()
            if old.encode() in content and b"\0" not in content:
                file.write_bytes(content.replace(old.encode(), new.encode()))
