"""Builds a workspace from a notebook, and makes its packages usable in the running kernel.

A running kernel cannot source a workspace, because Linux's loader reads ``LD_LIBRARY_PATH`` only when a process starts.
Instead, the kernel loads the package's libraries once with global symbols (``RTLD_GLOBAL``; 5 ms for a service type on
Jazzy). After that, code that opens these libraries by name finds them, such as rosidl's type support.
"""

from __future__ import annotations

import ctypes
import html
import importlib
import os
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from autograder.workspaces.builds.colcon_build import CannotCopyBuild, copy_to_workspace, describe_workspace
from autograder.workspaces.builds.install_folder import (
    package_prefixes,
    python_folders,
    with_prefixes,
)
from autograder.workspaces.builds.students_builds import OwnBuilds

if TYPE_CHECKING:
    from autograder.workspaces.builds.colcon_build import Build

MAX_LOG = 4_000
"""The maximum number of characters that are shown of the log of a failed build."""


@dataclass(frozen=True, repr=False)
class WorkspaceBuild:
    """The result of `build_workspace`, which a notebook shows below the cell.

    Attributes:
        build: The result of the build.
        note: A warning for the student; empty if there is none.
    """

    build: Build
    note: str = ""

    @property
    def ok(self) -> bool:
        """True if every package was built."""
        return self.build.ok

    def summary(self) -> str:
        """Return the result in one or two sentences."""
        made = self.build
        if not made.ok:
            where = f"colcon could not build {made.package}: " if made.package else ""
            return f"{where}{made.line}"
        names = ", ".join(package.name for package in made.packages)
        how = "built before from the same sources" if made.reused else f"built in {made.seconds:.1f} s"
        return f"{names}: {how}.{f' {self.note}' if self.note else ''}"

    def __repr__(self) -> str:
        log = f"\n\n{self.build.log[-MAX_LOG:]}" if self.build.log else ""
        return f"{self.summary()}{log}"

    def _repr_html_(self) -> str:
        line = html.escape(self.summary())
        if self.ok:
            return f"<p>{line}</p>"
        log = html.escape(self.build.log[-MAX_LOG:])
        whole = f"<details><summary>the log</summary><pre>{log}</pre></details>" if log else ""
        return f"<p><strong>Not built.</strong> <code>{line}</code></p>{whole}"


def build_workspace(folder: str | os.PathLike[str] = "ros2_ws") -> WorkspaceBuild:
    """Build a workspace as ``colcon build`` does, and make its packages available in this kernel.

    Sources that did not change are not built again. The packages are in the workspace's ``install`` folder, which a
    terminal can source. ``import``, and programs that this kernel starts from now on (such as ``!ros2 run``), find the
    packages without sourcing. If the kernel has already imported a package, it keeps the old version, and a note says
    so.

    Args:
        folder: The workspace folder, which contains ``src``.
    """
    made = OwnBuilds().build(describe_workspace(Path(folder)), None)
    if not made.ok:
        return WorkspaceBuild(made)
    try:
        install = copy_to_workspace(made)
    except CannotCopyBuild as error:
        return WorkspaceBuild(made, str(error))
    return WorkspaceBuild(made, _use(package_prefixes(install), made))


def _use(prefixes: list[Path], made: Build) -> str:
    names = {package.name for package in made.packages}
    chosen = [prefix for prefix in prefixes if prefix.name in names]
    os.environ.update(with_prefixes(os.environ, chosen))
    stale = [] if made.reused else [prefix.name for prefix in chosen if prefix.name in sys.modules]
    elsewhere = [prefix.name for prefix in chosen if _is_imported_from_elsewhere(prefix)]
    for prefix in chosen:
        for folder in map(str, reversed(python_folders(prefix))):
            if folder not in sys.path:
                sys.path.insert(0, folder)
        if prefix.name not in sys.modules:
            _load_libraries(prefix)
    importlib.invalidate_caches()
    old = sorted({*stale, *elsewhere})
    if not old:
        return ""
    return f"This kernel uses another version of {', '.join(old)}: restart the kernel to use the new one."


def _load_libraries(prefix: Path) -> None:
    """Load the libraries of a package into this process, so that code that opens them by name finds them.

    Raises:
        OSError: A library needs another library that does not exist.
    """
    waiting = sorted((prefix / "lib").glob("lib*.so"))
    while waiting:
        # A library may need another one of the package, and no file lists the right order. So try repeatedly until all
        # are loaded.
        failed: list[tuple[Path, OSError]] = []
        for library in waiting:
            try:
                ctypes.CDLL(str(library), mode=ctypes.RTLD_GLOBAL)
            except OSError as error:
                failed.append((library, error))
        if len(failed) == len(waiting):
            raise failed[0][1]
        waiting = [library for library, _ in failed]


def _is_imported_from_elsewhere(prefix: Path) -> bool:
    file = getattr(sys.modules.get(prefix.name), "__file__", None)
    return file is not None and not Path(file).is_relative_to(prefix)
