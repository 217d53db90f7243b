"""A build that a grade may rest on: made in a box of its own from the sources alone, taken over as data.

What comes of a box depends on the sources and on the tools, whose fingerprint is the key, so it may be used again
for the same sources, whoever hands them in. No box can write to the cache.
"""

from __future__ import annotations

import hashlib
import shutil
import time
from dataclasses import replace
from typing import TYPE_CHECKING

from autograder.workspaces import artefacts, cache
from autograder.workspaces.building import Build, choose, command, failed
from autograder.workspaces.packages import BadPackage, Package, key
from autograder.workspaces.plans import course_interfaces

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from autograder.workspaces.building import Targets
    from autograder.workspaces.jobs import Built, Jobs

FORMAT = "1"
"""Part of every key: change it when what is kept of a build changes."""
MAX_LINE = 1_000
"""Characters of a line of a build's output that are looked at."""


class TrustedBuilds:
    """Builds that one submission's workspaces need, from the cache or made.

    Args:
        folder: The cache. It belongs to the grader alone.
        jobs: Builds.
    """

    def __init__(self, folder: Path, jobs: Jobs) -> None:
        self._folder = folder
        self._jobs = jobs

    def place(self, name: str, entry: Path) -> Path:
        """See :meth:`autograder.workspaces.jobs.Jobs.place`."""
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
            targets: See :func:`autograder.workspaces.building.build`.
            name: See :meth:`autograder.workspaces.jobs.Jobs.place`.
            cancelled: Says when nobody waits for it any more.

        Returns:
            The build; its ``install`` is where this process sees it.
        """
        began = time.monotonic()
        chosen, found = choose(found, targets)
        if found.trouble:
            return found
        hidden = course_interfaces() if any(package.interface_files for package in chosen) else ()
        try:
            sources = self._key(found, chosen, name, hidden)
        except BadPackage as error:
            return replace(found, trouble="bad_package", line=str(error))
        with cache.entry(sources, self._folder) as entry:
            install = entry.folder / "install"
            made = replace(found, ok=True, install=install, reused=entry.complete)
            if not entry.complete:
                built = self._made(found, chosen, entry.folder, name, hidden, cancelled)
                log = self._log(built, name, entry.folder)
                if built.returncode != 0 or built.archive is None:
                    return failed(replace(found, seconds=time.monotonic() - began), log)
                try:
                    artefacts.unpack(built.archive, install)
                except artefacts.BadArtefacts as error:
                    return failed(replace(found, seconds=time.monotonic() - began), f"{log}\nerror: {error}")
                entry.finish()
            return replace(made, seconds=time.monotonic() - began)

    def _key(self, found: Build, chosen: Sequence[Package], name: str, hidden: Sequence[Path]) -> str:
        words = (
            FORMAT,
            type(self._jobs).__name__,
            name,
            *map(str, hidden),
            key(found.workspace / "src", chosen),
        )
        return hashlib.sha256("\0".join(words).encode()).hexdigest()

    def _made(
        self,
        found: Build,
        chosen: Sequence[Package],
        entry: Path,
        name: str,
        hidden: Sequence[Path],
        cancelled: Callable[[], bool],
    ) -> Built:
        src, place = entry / "src", self._jobs.place(name, entry)
        moved = []
        for package in chosen:
            inside = package.folder.relative_to(found.workspace / "src")
            shutil.copytree(package.folder, src / inside, dirs_exist_ok=True)
            moved.append(replace(package, folder=place / "src" / inside))
        try:
            return self._jobs.build(name, entry, command(moved, place), cancelled, hidden)
        finally:
            shutil.rmtree(src, ignore_errors=True)

    def _log(self, built: Built, name: str, entry: Path) -> str:
        """The output as text, cut to what can be looked at in no time whatever it is."""
        text = built.output.decode("utf-8", "replace").replace(f"{self._jobs.place(name, entry)}/", "")
        if built.returncode is None:
            text += "\nerror: the build did not end in time"
        return "\n".join(line[:MAX_LINE] for line in text.splitlines())
