"""A build that a grade may rest on: made in a box of its own from the sources alone, taken over as data.

What comes of a box depends on the bytes that it gets and on the tools. Their hash is the key, so it may be used again
for the same sources, whoever hands them in. No box can write to the cache.

Packages that hold interfaces and nothing else are often the same but for comments and spaces. When a second one comes
that means the same as one that was built before, a simplified form of it is built, with nobody's own words in it, and
serves all that are to come.
"""

from __future__ import annotations

import shutil
import time
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from autograder.workspaces.building import artefacts, cache
from autograder.workspaces.building.alone import or_alone
from autograder.workspaces.building.colcon import choose, command, failed, moved
from autograder.workspaces.grading.jobs import BUILD_SECONDS, BuildJob
from autograder.workspaces.running.plans import course_interfaces
from autograder.workspaces.sources.interface_packages import DEFINITIONS, holds_only_interfaces, simplified
from autograder.workspaces.sources.packages import key, sources_of, state
from autograder.workspaces.sources.tree import BadSources

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from autograder.workspaces.building.result import Build, Targets
    from autograder.workspaces.grading.jobs import Built, Jobs
    from autograder.workspaces.sources.packages import Package
    from autograder.workspaces.sources.tree import Tree

ROOM = 16_000_000
"""Bytes for all builds of one notebook together; an interface package has 1.3 million, a Python package far less."""
MAX_LINE = 1_000
"""Characters of a line of a build's output that are looked at."""
ONLY_PYTHON = (
    "-G",
    "Ninja",
    f"-DCMAKE_PROJECT_INCLUDE={Path(__file__).with_name('only_python.cmake')}",
    "-DCMAKE_C_FLAGS_RELEASE=-O0 -DNDEBUG",
    "-DCMAKE_CXX_FLAGS_RELEASE=-O0 -DNDEBUG",
)
"""For interface packages: 6 instead of 10 s of processor time, and what a Python node loads is all there."""
ONLY_FAST_DDS = {"STATIC_ROSIDL_TYPESUPPORT_C": "rosidl_typesupport_fastrtps_c"}


class BuildTookTooLong(RuntimeError):
    """Nothing can be said about sources whose build did not end in time."""


@dataclass(frozen=True)
class _Order:
    """A build that is ordered.

    Attributes:
        tree: What the box gets.
        packages: The packages in it; their folders are relative to the place of the build.
        cmake: More arguments for CMake.
        variables: More variables of the box's environment.
        hidden: What the box must not find of the environment.
        key: Stands for all this and for the tools.
    """

    tree: Tree
    packages: Sequence[Package]
    cmake: Sequence[str]
    variables: Mapping[str, str]
    hidden: Sequence[Path]
    key: str


class TrustedBuilds:
    """Builds that one submission's workspaces need, from the cache or made.

    Args:
        folder: The cache. It belongs to the grader alone.
        jobs: Builds.
        room: Bytes that all builds made here may add to the cache.
    """

    def __init__(self, folder: Path, jobs: Jobs, room: int = ROOM) -> None:
        self._folder = folder
        self._jobs = jobs
        self._room = room

    def place(self, name: str, entry: Path) -> Path:
        """See :meth:`autograder.workspaces.grading.jobs.Jobs.place`."""
        return self._jobs.place(name, entry)

    def build(
        self,
        found: Build,
        targets: Targets | None,
        *,
        name: str,
        cancelled: Callable[[], bool] = lambda: False,
    ) -> Build:
        """Build what is needed of a workspace.

        Args:
            found: The workspace, looked at.
            targets: See :func:`autograder.workspaces.building.colcon.build`.
            name: See :meth:`autograder.workspaces.grading.jobs.Jobs.place`.
            cancelled: Says when nobody waits for it any more.

        Returns:
            The build; its ``install`` is where this process sees it.

        Raises:
            BuildTookTooLong: It was ended for that.
        """
        return or_alone(found, targets, lambda there: self._build(there, targets, name, cancelled))

    def _build(
        self, found: Build, targets: Targets | None, name: str, cancelled: Callable[[], bool]
    ) -> Build:
        began = time.monotonic()
        chosen, found = choose(found, targets)
        if found.trouble:
            return found
        try:
            tree = sources_of(found.workspace / "src", chosen)
            simple = simplified(tree) if all(map(holds_only_interfaces, chosen)) else None
            order, shared = (self._order(one, found, chosen, name) if one else None for one in (tree, simple))
            assert order is not None
            made = self._built(found, order, shared, name, cancelled)
        except BadSources as error:
            return replace(found, trouble="bad_package", line=str(error))
        except cache.GivenUp as error:
            return replace(found, trouble="build", line=str(error))  # which nobody will read
        return replace(made, seconds=time.monotonic() - began)

    def _built(
        self, found: Build, order: _Order, shared: _Order | None, name: str, cancelled: Callable[[], bool]
    ) -> Build:
        for one in (order, shared):
            if one is not None and (made := self._kept(found, one.key)) is not None:
                return made
        met = self._folder / f"{shared.key}.met" if shared is not None else None
        if shared is not None and met is not None and met.exists():
            made = self._make(found, shared, name, cancelled)
            if made.ok:
                return made
        made = self._make(found, order, name, cancelled)
        if made.ok and met is not None:
            met.touch()
        return made

    def _kept(self, found: Build, key: str) -> Build | None:
        """What is there already; None where it is not, or is just being made."""
        if not cache.is_complete(key, self._folder):
            return None
        with cache.entry(key, self._folder) as entry:
            if not entry.complete:
                return None
            return replace(found, ok=True, install=entry.folder / "install", reused=True)

    def _make(self, found: Build, order: _Order, name: str, cancelled: Callable[[], bool]) -> Build:
        with cache.entry(order.key, self._folder, cancelled) as entry:
            install = entry.folder / "install"
            made = replace(found, ok=True, install=install, reused=entry.complete)
            if entry.complete:
                return made
            built = self._run(order, entry.folder, name, cancelled)
            if built.late:
                raise BuildTookTooLong(
                    f"a build did not end within {BUILD_SECONDS:g} s; is the machine too busy?"
                )
            log = self._log(built, name, entry.folder)
            if built.returncode != 0 or built.archive is None:
                return failed(found, log)
            try:
                # What is in the cache stays there for a while, and others need the room, too.
                self._room -= artefacts.unpack(built.archive, install, self._room)
            except artefacts.BadArtefacts as error:
                return failed(found, f"{log}\nerror: {error}")
            entry.finish()
            return made

    def _run(self, order: _Order, entry: Path, name: str, cancelled: Callable[[], bool]) -> Built:
        place = self._jobs.place(name, entry)
        order.tree.write(entry / "src")
        words = command(moved(order.packages, Path("src"), place / "src"), place, order.cmake)
        try:
            return self._jobs.build(BuildJob(name, entry, words, order.variables, cancelled, order.hidden))
        finally:
            shutil.rmtree(entry / "src", ignore_errors=True)

    def _order(self, tree: Tree, found: Build, chosen: Sequence[Package], name: str) -> _Order:
        cmake, variables = (ONLY_PYTHON, ONLY_FAST_DDS) if _are_light(chosen) else ((), {})
        hidden = _hidden_from(chosen)
        packages = moved(chosen, found.workspace / "src", Path("src"))
        words = (
            type(self._jobs).__name__,
            name,
            *command(packages, Path(), cmake),
            *(f"{variable}={value}" for variable, value in variables.items()),
            *(f"hidden {path}" for path in hidden),
            *(f"{path} {state(str(path))}" for path in course_interfaces() if path not in hidden),
        )
        return _Order(tree, packages, cmake, variables, hidden, key(tree, *words))

    def _log(self, built: Built, name: str, entry: Path) -> str:
        """The output as text, cut to what can be looked at in no time whatever it is."""
        text = built.output.decode("utf-8", "replace").replace(f"{self._jobs.place(name, entry)}/", "")
        if built.returncode is None:
            text += "\nerror: the build took more memory, processes or processor time than a build may take"
        return "\n".join(line[:MAX_LINE] for line in text.splitlines())


def _are_light(packages: Sequence[Package]) -> bool:
    return any(holds_only_interfaces(package) for package in packages) and all(
        holds_only_interfaces(package) or package.build_type == "ament_python" for package in packages
    )


def _hidden_from(packages: Sequence[Package]) -> Sequence[Path]:
    makes_interfaces = any(file.suffix in DEFINITIONS for p in packages for file in p.interface_files)
    return course_interfaces() if makes_interfaces else ()
