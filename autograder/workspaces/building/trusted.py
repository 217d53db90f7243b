"""A build that a grade may rest on: made in a box of its own from the sources alone, taken over as data.

What comes of a box depends on the sources and on the tools, whose fingerprint is the key, so it may be used again
for the same sources, whoever hands them in. No box can write to the cache.

Packages that hold interfaces and nothing else are often the same but for comments and spaces. When a second one comes
that means the same as one that was built before, a simplified form of it is built, with nobody's own words in it, and
serves all that are to come.
"""

from __future__ import annotations

import hashlib
import shutil
import tempfile
import time
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from autograder.workspaces.building import artefacts, cache
from autograder.workspaces.building.alone import or_alone
from autograder.workspaces.building.colcon import choose, command, failed
from autograder.workspaces.grading.jobs import BUILD_SECONDS, BuildJob
from autograder.workspaces.running.plans import course_interfaces
from autograder.workspaces.sources.interface_packages import DEFINITIONS, holds_only_interfaces, simplify
from autograder.workspaces.sources.packages import BadPackage, Package, key

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from autograder.workspaces.building.result import Build, Targets
    from autograder.workspaces.grading.jobs import Built, Jobs

ROOM = 16_000_000
"""Bytes for all builds of one notebook together; an interface package has 1.3 million, a Python package far less."""
FORMAT = "2"
"""Part of every key: change it when what is kept of a build changes."""
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
class _Staged:
    """Sources as they are built.

    Attributes:
        src: Where they are.
        packages: The packages there.
        key: Stands for them and for the tools.
    """

    src: Path
    packages: tuple[Package, ...]
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
            with self._staged(found, chosen, name) as staged, self._simplified(found, chosen, name) as simple:
                made = self._built(found, staged, simple, name, cancelled)
        except BadPackage as error:
            return replace(found, trouble="bad_package", line=str(error))
        except cache.GivenUp as error:
            return replace(found, trouble="build", line=str(error))  # which nobody will read
        return replace(made, seconds=time.monotonic() - began)

    def _built(
        self, found: Build, staged: _Staged, simple: _Staged | None, name: str, cancelled: Callable[[], bool]
    ) -> Build:
        for one in (staged, simple):
            if one is not None and (made := self._kept(found, one)) is not None:
                return made
        met = self._folder / f"{simple.key}.met" if simple is not None else None
        if simple is not None and met is not None and met.exists():
            made = self._make(found, simple, name, cancelled)
            if made.ok:
                return made
        made = self._make(found, staged, name, cancelled)
        if made.ok and met is not None:
            met.touch()
        return made

    def _kept(self, found: Build, staged: _Staged) -> Build | None:
        """What is there already; None where it is not, or is just being made."""
        if not cache.is_complete(staged.key, self._folder):
            return None
        with cache.entry(staged.key, self._folder) as entry:
            if not entry.complete:
                return None
            return replace(found, ok=True, install=entry.folder / "install", reused=True)

    def _make(self, found: Build, staged: _Staged, name: str, cancelled: Callable[[], bool]) -> Build:
        with cache.entry(staged.key, self._folder, cancelled) as entry:
            install = entry.folder / "install"
            made = replace(found, ok=True, install=install, reused=entry.complete)
            if entry.complete:
                return made
            built = self._run(staged, entry.folder, name, cancelled)
            if built.late:
                raise BuildTookTooLong(
                    f"a build did not end within {BUILD_SECONDS:g} s; is the machine too busy?"
                )
            log = self._log(built, name, entry.folder)
            if built.returncode != 0 or built.archive is None:
                return failed(found, log)
            # Before it is written: what is in the cache stays there for a while, and others need the room, too.
            if len(built.archive) > self._room:
                error = f"error: the builds of one notebook may take {ROOM // 10**6} MB together, and these take more"
                return failed(found, f"{log}\n{error}")
            self._room -= len(built.archive)
            try:
                artefacts.unpack(built.archive, install)
            except artefacts.BadArtefacts as error:
                return failed(found, f"{log}\nerror: {error}")
            entry.finish()
            return made

    def _run(self, staged: _Staged, entry: Path, name: str, cancelled: Callable[[], bool]) -> Built:
        place = self._jobs.place(name, entry)
        shutil.copytree(staged.src, entry / "src", dirs_exist_ok=True)
        seen = [
            replace(package, folder=place / "src" / package.folder.relative_to(staged.src))
            for package in staged.packages
        ]
        light = _are_light(staged.packages)
        words = command(seen, place, ONLY_PYTHON if light else ())
        hidden = _hidden_from(staged.packages)
        try:
            variables = ONLY_FAST_DDS if light else {}
            return self._jobs.build(BuildJob(name, entry, words, variables, cancelled, hidden))
        finally:
            shutil.rmtree(entry / "src", ignore_errors=True)

    @contextmanager
    def _staged(self, found: Build, chosen: Sequence[Package], name: str) -> Iterator[_Staged]:
        """A copy of what is to be built, with its key."""
        src = Path(tempfile.mkdtemp(prefix="stage-", dir=self._folder))
        try:
            moved = []
            for package in chosen:
                folder = src / package.folder.relative_to(found.workspace / "src")
                shutil.copytree(package.folder, folder, dirs_exist_ok=True)
                moved.append(replace(package, folder=folder))
            yield _Staged(src, tuple(moved), self._key(src, moved, name))
        finally:
            shutil.rmtree(src, ignore_errors=True)

    @contextmanager
    def _simplified(self, found: Build, chosen: Sequence[Package], name: str) -> Iterator[_Staged | None]:
        """The same in a form that all share which mean the same; None where there is no such form."""
        if not all(holds_only_interfaces(package) for package in chosen):
            yield None
            return
        with self._staged(found, chosen, name) as staged:
            for package in staged.packages:
                simplify(package.folder)
            yield replace(staged, key=self._key(staged.src, staged.packages, name))

    def _key(self, src: Path, packages: Sequence[Package], name: str) -> str:
        light = "".join(ONLY_PYTHON) if _are_light(packages) else ""
        hidden = map(str, _hidden_from(packages))
        words = (FORMAT, type(self._jobs).__name__, name, light, *hidden, key(src, packages))
        return hashlib.sha256("\0".join(words).encode()).hexdigest()

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
