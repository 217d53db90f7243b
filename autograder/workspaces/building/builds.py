"""Builds of workspaces, each made once for the same sources: in a student's kernel, in a terminal and for a class.

The sources are read once. What comes of a build depends on these bytes and on the tools: their hash is the key under
which it is kept. Who runs it (:class:`autograder.workspaces.jobs.Builder`) is all that differs between the
places.
"""

from __future__ import annotations

import os
import shutil
import time
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from autograder.workspaces.building import artefacts, cache
from autograder.workspaces.building.colcon import choose, command, failed, moved
from autograder.workspaces.jobs import BuildOrder
from autograder.workspaces.sources.finding import WORKSPACE
from autograder.workspaces.sources.interface_packages import holds_only_interfaces
from autograder.workspaces.sources.packages import key, sources_of
from autograder.workspaces.sources.tree import BadSources
from environment.interface_packages import ONLY_PYTHON

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from autograder.workspaces.building.colcon import Build, Targets
    from autograder.workspaces.jobs import Builder, Built
    from autograder.workspaces.sources.packages import Package

MAX_LINE = 1_000
"""Characters of a line of a build's output that are looked at."""
NO_DEFAULTS = {"COLCON_DEFAULTS_FILE": os.devnull}
"""Turns off a user's own settings for colcon, which are not in the key."""


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
        builder: Runs colcon.
    """

    def __init__(self, folder: Path, builder: Builder) -> None:
        self._folder = folder
        self._builder = builder

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
            name: See :meth:`autograder.workspaces.jobs.Builder.place`.
            cancelled: Says when nobody waits for it any more.

        Returns:
            The build; its ``install`` is where this process sees it.

        Raises:
            BuildTookTooLong: It was ended for that.
        """
        made = self._build(found, targets, name, cancelled)
        wanted = set(targets(found)) if targets is not None and made.trouble == "build" else set[str]()
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
            order = BuildOrder(name, tree, packages, cancelled, cmake, NO_DEFAULTS)
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
                type(self._builder).__name__,
                order.name,
                *command(order.packages, Path(), order.cmake),
                *(f"{variable}={value}" for variable, value in order.variables.items()),
                *(f"hidden {path}" for path in order.hidden),
                *words,
            ),
        )

    def _entry(self, found: Build, order: BuildOrder) -> Build:
        with cache.entry(order.key, self._folder, order.cancelled) as entry:
            install = entry.folder / "install"
            if entry.complete:
                return replace(found, ok=True, install=install, reused=True)
            made = self._make(found, order, entry)
            if made.ok:
                entry.finish()
            return made

    def _make(self, found: Build, order: BuildOrder, entry: cache.Entry) -> Build:
        place, install = self._builder.place(order.name, entry.folder), entry.folder / "install"
        order.tree.write(entry.folder / "src")
        words = command(moved(order.packages, Path("src"), place / "src"), place, order.cmake)
        try:
            built = self._builder.build(order, words, entry)
        finally:
            shutil.rmtree(entry.folder / "src", ignore_errors=True)
        log = _log(built, place)
        if built.late:
            raise BuildTookTooLong(built.late, found, log)
        if built.returncode != 0:
            return failed(found, log)
        try:
            self._take(built, install)
        except artefacts.BadArtefacts as error:
            return failed(found, f"{log}\nerror: {error}")
        return replace(found, ok=True, install=install)

    def _take(self, built: Built, install: Path) -> None:
        """Put into the cache what a build has made, where it was not made there.

        Raises:
            BadArtefacts: It cannot be taken.
        """


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
