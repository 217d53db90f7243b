"""The environment in which the packages of an install folder are found: what ``source install/setup.bash`` does.

The variables are worked out here because sourcing needs a shell, half a second, and a path without spaces.
"""

from __future__ import annotations

import os
import sys
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from pathlib import Path

LIBRARY = f"lib/python{sys.version_info.major}.{sys.version_info.minor}/site-packages"


def package_prefixes(install: Path) -> list[Path]:
    """The prefix of each package in an isolated install folder, in the order of their names."""
    if not install.is_dir():
        return []
    return sorted(folder for folder in install.iterdir() if (folder / "share").is_dir())


def python_folders(prefix: Path) -> list[Path]:
    """The folders of a prefix that Python imports from."""
    # Debian's Python installs into dist-packages where it is told a prefix of its own.
    candidates = [prefix / LIBRARY, prefix / "local" / LIBRARY.replace("site-", "dist-")]
    return [folder for folder in candidates if folder.is_dir()]


def with_prefixes(
    environment: Mapping[str, str], prefixes: Iterable[Path], *, last: bool = False
) -> dict[str, str]:
    """An environment in which packages of these prefixes are found.

    Args:
        environment: The one to begin with.
        prefixes: One for each package.
        last: Whether packages that the environment has already come first.
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
        there = [part for part in there if part not in ours]
        if joined := [*there, *ours] if last else [*ours, *there]:
            result[name] = os.pathsep.join(joined)
    return result


def relocated(environment: Mapping[str, str], here: Path, there: Path) -> dict[str, str]:
    """The environment for somebody who sees one folder at another place."""
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
    """The environment without what is in a workspace: a build must not see the results of the one before."""
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
