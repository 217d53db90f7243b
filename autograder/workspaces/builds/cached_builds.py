"""Makes builds of workspaces, and stores them in a cache, so that the same sources are built only once.

The key of a build in the cache is a hash of the sources and of the build tools, because the result depends on nothing
else. The sources are read only once, for both the hash and the build, so that the two cannot differ. Builds in a
student's kernel, in a terminal and for a class differ only in the process that makes them
(:class:`autograder.workspaces.jobs.Jobs`).
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

from autograder.workspaces.builds import build_artifacts, build_cache
from autograder.workspaces.builds.colcon_build import (
    colcon_command,
    failed_build,
    moved_packages,
    packages_to_build,
)
from autograder.workspaces.builds.install_folder import merge_prefixes, rename_paths
from autograder.workspaces.builds.plain_packages import put_texts, split
from autograder.workspaces.jobs import BuildJob
from autograder.workspaces.packages import WORKSPACE, sources_of
from autograder.workspaces.sources import BadSources
from course_runtime.interface_packages import ONLY_PYTHON, ONLY_PYTHON_FILE

if TYPE_CHECKING:
    from collections.abc import Callable

    from autograder.workspaces.builds.colcon_build import Build, Targets
    from autograder.workspaces.jobs import BuildOutcome, Jobs
    from autograder.workspaces.sources import SourceTree


FORMAT = "3"
"""The version of the layout of a build in the cache; it is part of every key. Change it when the layout changes."""
MAX_LINE = 1_000
"""The number of characters after which a line of a build's output is cut."""
NO_DEFAULTS = {"COLCON_DEFAULTS_FILE": os.devnull}
"""Environment variables that make colcon ignore the user's own settings. The key of a build in the cache does not cover
these settings, so they must not affect the build.
"""


class BuildTookTooLong(RuntimeError):
    """A build did not end in time, so its sources cannot be judged.

    Args:
        seconds: The time limit in seconds.
        log: The output of the build so far.

    Attributes:
        build: The description of the failed build.
    """

    def __init__(self, seconds: float, found: Build, log: str) -> None:
        super().__init__(f"a build did not end within {seconds:g} s; is the machine too busy?")
        self.build = replace(failed_build(found, log), line=str(self))


class Builds:
    """Finds builds of workspaces in a cache, or makes them.

    Args:
        folder: The folder of the cache.
        jobs: Runs colcon and the built programs.
        room: The maximum size in bytes that a build may add to the cache, if the build comes as an archive.

    Attributes:
        jobs: The argument ``jobs``.
    """

    def __init__(self, folder: Path, jobs: Jobs, room: int = build_artifacts.MAX_BYTES) -> None:
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
        """Build the packages of a workspace that an exercise needs.

        If only a dependency fails, the needed packages are built again without their dependencies. For example,
        ``my_robot_pkg`` depends on ``my_robot_interfaces`` from Lab 1.3 on, but its programs of earlier labs do not
        import ``my_robot_interfaces`` and should still run. A program that does import it then fails when it runs.

        Args:
            found: The workspace, as :func:`autograder.workspaces.builds.colcon_build.describe_workspace` returns it.
            targets: A function that returns the names of the needed packages; None if all packages are needed.
            name: The kind of workspace; see :meth:`autograder.workspaces.jobs.Jobs.place`.
            cancelled: Returns True when the build is no longer needed.

        Returns:
            The build; its ``install`` is a path that this process can use.

        Raises:
            BuildTookTooLong: The build was stopped at its time limit.
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
        # Only Python packages can be built without their dependencies; CMake fails if a dependency is missing.
        if any(package.build_type != "ament_python" for package in own):
            return made
        alone = self._build(replace(found, packages=own), targets, name, cancelled)
        return replace(alone, packages=found.packages) if alone.ok else made

    def lend(self, made: Build, course: Build) -> Build:
        """Return a copy of the course's build to which the student's files have been added.

        The copy is used if the student's package lacks programs that the course's package has. The student's files must
        be added because ROS finds a package in one prefix only, which must also contain the student's launch files.
        """
        assert course.install is not None
        names = {prefix.name for prefix in made.prefixes}
        built = [package for package in made.packages if package.name in names]
        sources = sources_of(made.workspace / "src", built)
        key = build_key(sources, type(self.jobs).__name__, "lent", course.install.parent.name)
        with build_cache.entry(key, self._folder) as entry:
            install = entry.folder / "install"
            if not entry.complete:
                merge_prefixes(course.prefixes, made.prefixes, install)
                entry.finish()
        return replace(course, install=install)

    def _build(
        self, found: Build, targets: Targets | None, name: str, cancelled: Callable[[], bool]
    ) -> Build:
        began = time.monotonic()
        chosen, found = packages_to_build(found, targets)
        if found.trouble:
            return found
        src = found.workspace / "src"
        try:
            tree, packages = sources_of(src, chosen), moved_packages(chosen, src, Path("src"))
            # If every package is an interface package or a Python package, no C++ of the interfaces is needed.
            only_python = all(
                package.holds_only_interfaces or package.build_type == "ament_python" for package in chosen
            )
            interfaces = any(package.holds_only_interfaces for package in chosen)
            cmake = ONLY_PYTHON if only_python and interfaces else ()
            job = BuildJob(name, found.workspace, tree, packages, cancelled, cmake, NO_DEFAULTS)
            made = self._entry(found, self._keyed(job))
        except BadSources as error:
            return replace(found, trouble="bad_package", line=str(error))
        except build_cache.GivenUp as error:
            # The caller has canceled the build, so no student will see this reason.
            return replace(found, trouble="build", line=str(error))
        return replace(made, seconds=time.monotonic() - began)

    def _keyed(self, job: BuildJob, *words: str) -> BuildJob:
        """Return the job with its key for the cache: a hash of the job and of other facts (``words``)."""
        return replace(
            job,
            key=build_key(
                job.tree,
                type(self.jobs).__name__,
                job.name,
                *colcon_command(job.packages, Path(), job.cmake),
                *(f"{variable}={value}" for variable, value in job.variables.items()),
                *(f"hidden {path}" for path in job.hidden),
                *words,
            ),
        )

    def _entry(self, found: Build, job: BuildJob, folder: Path | None = None) -> Build:
        """Return a build from the cache in ``folder`` (None for the cache of this object), or make it there."""
        with build_cache.entry(job.key, folder or self._folder, job.cancelled) as entry:
            install = entry.folder / "install"
            if entry.complete:
                return replace(found, ok=True, install=install, reused=True)
            made = self._make(found, job, entry)
            if made.ok:
                entry.finish()
            return made

    def _make(self, found: Build, job: BuildJob, entry: build_cache.CachedBuild) -> Build:
        parts = split(job)
        if parts == [job]:
            return self._run_colcon(found, job, entry)
        install = entry.folder / "install"
        for part in parts:
            made = self._entry(found, self._keyed(part))
            if made.install is None:
                return made
            ignored = shutil.ignore_patterns("__pycache__")
            shutil.copytree(made.install, install, symlinks=True, ignore=ignored, dirs_exist_ok=True)
            old, new = (self.jobs.place(job.name, folder) for folder in (made.install.parent, entry.folder))
            rename_paths(install, str(old), str(new))
        put_texts(job.tree, install)
        return replace(found, ok=True, install=install)

    def _run_colcon(self, found: Build, job: BuildJob, entry: build_cache.CachedBuild) -> Build:
        place, install = self.jobs.place(job.name, entry.folder), entry.folder / "install"
        job.tree.write(entry.folder / "src")
        words = colcon_command(moved_packages(job.packages, Path("src"), place / "src"), place, job.cmake)
        try:
            built = self.jobs.build(job, words, entry)
        finally:
            shutil.rmtree(entry.folder / "src", ignore_errors=True)
        log = _log(built, place)
        if built.late:
            raise BuildTookTooLong(built.late, found, log)
        if built.returncode != 0:
            return failed_build(found, log)
        try:
            if built.archive is not None:
                # The build may only use the space that is left in the cache.
                build_artifacts.unpack(built.archive, install, self._room)
        except build_artifacts.BadArtifacts as error:
            return failed_build(found, f"{log}\nerror: {error}")
        return replace(found, ok=True, install=install)


def build_key(tree: SourceTree, *words: str) -> str:
    """Return the key of a build: a hash of the sources, of the build tools, and of ``words``.

    Args:
        words: Other facts that influence the build, such as the command.
    """
    return hashlib.sha256("\0".join((FORMAT, tree.digest, *_toolchain(), *words)).encode()).hexdigest()


_TOOLS = ("colcon_core-", "colcon_cmake-", "colcon_ros-", "setuptools-", "cmake-")
_ENVIRONMENT = ("CC", "CXX", "CFLAGS", "CXXFLAGS", "LDFLAGS", "CMAKE_GENERATOR", "RMW_IMPLEMENTATION")


def _toolchain() -> tuple[str, ...]:
    """Return the tools that influence a build, with their versions: Python, colcon, compilers and so on."""
    programs = [
        shutil.which(os.environ.get(name) or usual) or "" for name, usual in (("CC", "cc"), ("CXX", "c++"))
    ]
    variables = [f"{name}={os.environ.get(name, '')}" for name in _ENVIRONMENT]
    return (
        sys.version,
        sys.prefix,
        *_tools(),
        *(f"{program} {file_state(program)}" for program in programs),
        f"ros {_underlay()}",
        hashlib.sha256(ONLY_PYTHON_FILE.read_bytes()).hexdigest(),
        os.environ.get("ROS_DISTRO", ""),
        *variables,
    )


def _underlay() -> str:
    """Return path, size and time of a file in the first ROS installation that a build finds; empty if there is none."""
    for prefix in filter(None, (*os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep), sys.prefix)):
        generators = str(Path(prefix, "share", "rosidl_default_generators", "package.xml"))
        if mark := file_state(generators):
            return f"{generators} {mark}"
    return ""


@functools.cache
def _tools() -> tuple[str, ...]:
    """Return the build tools with their versions, such as ``colcon_core-0.18.1.dist-info``.

    Only the names of folders (PEP 376) are read, because importlib.metadata takes five times as long, and this function
    is called each time a program in a workspace starts.
    """
    entries: set[str] = set()
    for folder in filter(None, sys.path):
        # Like Python, skip an entry of sys.path that is missing, unreadable or not a folder.
        with contextlib.suppress(OSError):
            entries.update(entry.name for entry in Path(folder).iterdir())
    return tuple(sorted(e for e in entries if e.startswith(_TOOLS) and e.endswith(("dist-info", "egg-info"))))


def file_state(file: str) -> str:
    """Return the size and the modification time of a file as text; empty if the file is missing."""
    try:
        found = Path(file).stat()
    except OSError:
        return ""
    return f"{found.st_size} {found.st_mtime_ns}"


def _log(built: BuildOutcome, place: Path) -> str:
    """Return the output of a build as text. Long lines are cut, so that any output can be parsed quickly."""
    text = built.output.decode("utf-8", "replace").replace(f"{place}/", "")
    if built.returncode is None:
        text += "\nerror: the build used more memory, processes or processor time than is allowed"
    return "\n".join(line[:MAX_LINE] for line in text.splitlines())
