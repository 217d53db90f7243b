"""Builds of workspaces, each made once for the same sources: in a student's kernel, in a terminal and for a class.

The sources are read once. What comes of a build depends on these bytes and on the tools: their hash is the key under
which it is kept. Where it runs (:class:`autograder.workspaces.jobs.Jobs`) is all that differs between the places.
"""

from __future__ import annotations

import contextlib
import functools
import hashlib
import os
import shutil
import sys
import time
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from autograder.workspaces import artefacts, cache
from autograder.workspaces.colcon import choose, command, failed, moved
from autograder.workspaces.interface_packages import holds_only_interfaces
from autograder.workspaces.jobs import BuildOrder
from autograder.workspaces.packages import WORKSPACE, sources_of
from autograder.workspaces.sources import BadSources
from environment.interface_packages import ONLY_PYTHON, ONLY_PYTHON_FILE

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from autograder.workspaces.colcon import Build, Targets
    from autograder.workspaces.jobs import Built, Jobs
    from autograder.workspaces.packages import Package
    from autograder.workspaces.sources import Tree

FORMAT = "3"
"""Part of every key: change it when what is kept of a build changes."""
MAX_LINE = 1_000
"""Characters of a line of a build's output that are looked at."""
NO_DEFAULTS = {"COLCON_DEFAULTS_FILE": os.devnull}
"""Turns off a user's own settings for colcon, which are not in the key."""
_TOOLS = ("colcon_core-", "colcon_cmake-", "colcon_ros-", "setuptools-", "cmake-")
_ENVIRONMENT = ("CC", "CXX", "CFLAGS", "CXXFLAGS", "LDFLAGS", "CMAKE_GENERATOR", "RMW_IMPLEMENTATION")


class BuildTookTooLong(RuntimeError):
    """Nothing can be said about sources whose build did not end in time.

    Args:
        seconds: The time that it had.
        found: The workspace.
        log: What the build said until then.

    Attributes:
        build: The same as a build that failed.
    """

    def __init__(self, seconds: float, found: Build, log: str) -> None:
        super().__init__(f"a build did not end within {seconds:g} s; is the machine too busy?")
        self.build = replace(failed(found, log), line=str(self))


class Builds:
    """Builds of workspaces, from a cache or made.

    Args:
        folder: The cache.
        jobs: Run colcon, and what was built.
        room: Bytes that a build may add to the cache, where it comes to it as an archive.

    Attributes:
        jobs: The same.
    """

    def __init__(self, folder: Path, jobs: Jobs, room: int = artefacts.MAX_BYTES) -> None:
        self._folder = folder
        self.jobs = jobs
        self._room = room

    def build(
        self,
        found: Build,
        targets: Targets | None,
        *,
        name: str = WORKSPACE,
        cancelled: Callable[[], bool] = lambda: False,
    ) -> Build:
        """Build what is needed of a workspace.

        A package that a needed one names in package.xml and that fails takes nothing away from it: it is built without
        that one. ``my_robot_pkg`` depends on ``my_robot_interfaces`` from Lab 1.3 on, and its programs of the labs
        before import nothing of it. What a program does import it finds where it runs, among the packages that come
        with the course, or it says that it is missing.

        Args:
            found: The workspace, looked at.
            targets: Which packages are needed; they are built with what they depend on, or without it where only that
                fails. None for all.
            name: See :meth:`autograder.workspaces.jobs.Jobs.place`.
            cancelled: Says when nobody waits for it any more.

        Returns:
            The build; its ``install`` is where this process sees it.

        Raises:
            BuildTookTooLong: It was ended for that.
        """
        made = self._build(found, targets, name, cancelled)
        wanted = (
            set(targets(found))
            if targets is not None and made.trouble in ("build", "entry_point")
            else set[str]()
        )
        if not wanted or not made.package or made.package in wanted:
            return made
        own = tuple(package for package in found.packages if package.name in wanted)
        # CMake looks for what a package depends on while it is built; setuptools does not.
        if any(package.build_type != "ament_python" for package in own):
            return made
        alone = self._build(replace(found, packages=own), targets, name, cancelled)
        return replace(alone, packages=found.packages) if alone.ok else made

    def _build(
        self, found: Build, targets: Targets | None, name: str, cancelled: Callable[[], bool]
    ) -> Build:
        began = time.monotonic()
        chosen, found = choose(found, targets)
        if found.trouble:
            return found
        src = found.workspace / "src"
        try:
            tree, packages = sources_of(src, chosen), moved(chosen, src, Path("src"))
            cmake = ONLY_PYTHON if _are_light(chosen) else ()
            order = BuildOrder(name, found.workspace, tree, packages, cancelled, cmake, NO_DEFAULTS)
            made = self._find_or_make(found, chosen, order)
        except BadSources as error:
            return replace(found, trouble="bad_package", line=str(error))
        except cache.GivenUp as error:
            return replace(found, trouble="build", line=str(error))  # which nobody will read
        return replace(made, seconds=time.monotonic() - began)

    def _find_or_make(self, found: Build, chosen: Sequence[Package], order: BuildOrder) -> Build:
        """The build of the chosen packages; the order says the same with their folders inside the place."""
        del chosen
        return self._entry(found, self._keyed(order))

    def _keyed(self, order: BuildOrder, *words: str) -> BuildOrder:
        """The order with its key, which more words than all that it is made of may be in."""
        return replace(
            order,
            key=key(
                order.tree,
                type(self.jobs).__name__,
                order.name,
                *command(order.packages, Path(), order.cmake),
                *(f"{variable}={value}" for variable, value in order.variables.items()),
                *(f"hidden {path}" for path in order.hidden),
                *words,
            ),
        )

    def _entry(self, found: Build, order: BuildOrder, folder: Path | None = None) -> Build:
        """The build from a cache, or made in it; the cache of these builds if none is named."""
        with cache.entry(order.key, folder or self._folder, order.cancelled) as entry:
            install = entry.folder / "install"
            if entry.complete:
                return replace(found, ok=True, install=install, reused=True)
            made = self._make(found, order, entry)
            if made.ok:
                entry.finish()
            return made

    def _make(self, found: Build, order: BuildOrder, entry: cache.Entry) -> Build:
        place, install = self.jobs.place(order.name, entry.folder), entry.folder / "install"
        order.tree.write(entry.folder / "src")
        words = command(moved(order.packages, Path("src"), place / "src"), place, order.cmake)
        try:
            built = self.jobs.build(order, words, entry)
        finally:
            shutil.rmtree(entry.folder / "src", ignore_errors=True)
        log = _log(built, place)
        if built.late:
            raise BuildTookTooLong(built.late, found, log)
        if built.returncode != 0:
            return failed(found, log)
        try:
            if built.archive is not None:
                # What is in the cache stays there for a while, and others need the room, too.
                artefacts.unpack(built.archive, install, self._room)
        except artefacts.BadArtefacts as error:
            return failed(found, f"{log}\nerror: {error}")
        return replace(found, ok=True, install=install)


def key(tree: Tree, *words: str) -> str:
    """The key of a build: everything that is built, and everything that builds it.

    Args:
        tree: What is built.
        words: How it is built, such as the command.
    """
    return hashlib.sha256("\0".join((FORMAT, tree.digest, *toolchain(), *words)).encode()).hexdigest()


def toolchain() -> tuple[str, ...]:
    """All else that decides on a build: the interpreter, the build tools, the compiler and the underlay."""
    programs = [
        shutil.which(os.environ.get(name) or usual) or "" for name, usual in (("CC", "cc"), ("CXX", "c++"))
    ]
    variables = [f"{name}={os.environ.get(name, '')}" for name in _ENVIRONMENT]
    return (
        sys.version,
        sys.prefix,
        *_tools(),
        *(f"{program} {state(program)}" for program in programs),
        f"ros {_underlay()}",
        hashlib.sha256(ONLY_PYTHON_FILE.read_bytes()).hexdigest(),
        os.environ.get("ROS_DISTRO", ""),
        *variables,
    )


def _underlay() -> str:
    """The ROS that a build finds first, sourced or of the environment, and a mark of it; empty where there is none."""
    for prefix in filter(None, (*os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep), sys.prefix)):
        generators = str(Path(prefix, "share", "rosidl_default_generators", "package.xml"))
        if mark := state(generators):
            return f"{generators} {mark}"
    return ""


@functools.cache
def _tools() -> tuple[str, ...]:
    """The build tools and their versions, as the names of their folders have them (PEP 376).

    Asked at each start of a program in a workspace: to import importlib.metadata costs five times as much.
    """
    entries: set[str] = set()
    for folder in filter(None, sys.path):
        # One that is not there, is no folder or may not be read: Python passes over it, too.
        with contextlib.suppress(OSError):
            entries.update(entry.name for entry in Path(folder).iterdir())
    return tuple(sorted(e for e in entries if e.startswith(_TOOLS) and e.endswith(("dist-info", "egg-info"))))


def state(file: str) -> str:
    """A mark of a file of the tools, not shared by a later one of its name; empty where there is none."""
    try:
        found = Path(file).stat()
    except OSError:
        return ""
    return f"{found.st_size} {found.st_mtime_ns}"


def _are_light(packages: Sequence[Package]) -> bool:
    return any(holds_only_interfaces(package) for package in packages) and all(
        holds_only_interfaces(package) or package.build_type == "ament_python" for package in packages
    )


def _log(built: Built, place: Path) -> str:
    """The output as text, cut to what can be looked at in no time whatever it is."""
    text = built.output.decode("utf-8", "replace").replace(f"{place}/", "")
    if built.returncode is None:
        text += "\nerror: the build took more memory, processes or processor time than a build may take"
    return "\n".join(line[:MAX_LINE] for line in text.splitlines())
