"""Builds a student's own workspace, in a notebook or a terminal on the student's own computer.

In a graded notebook, builds are requested from the grader instead, both for a check and for the command ``colcon
build`` in a cell. The notebook's box cannot see the grader's folders, so it receives each build as an archive.
"""

from __future__ import annotations

import contextlib
import os
from dataclasses import replace
from typing import TYPE_CHECKING

from autograder.messages import workspaces as messages
from autograder.messages.lines import Hangup, Lines, NotUnderstood
from autograder.workspaces.builds import artefacts, cache
from autograder.workspaces.builds.builds import Builds, BuildTookTooLong
from autograder.workspaces.builds.install_folder import rename_paths
from autograder.workspaces.builds.own_install import changed_since, is_current
from autograder.workspaces.packages import WORKSPACE
from autograder.workspaces.running.plain_jobs import PlainJobs
from autograder.workspaces.sources import BadSources, collect_workspace

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence
    from pathlib import Path

    from autograder.workspaces.builds.colcon import Build, Targets
    from autograder.workspaces.packages import Package
    from autograder.workspaces.running.jobs import BuildOrder

GRADERS = "AUTOGRADER_BUILDS"
"""The environment variable that, in a graded notebook, contains the path of the grader's socket."""
LIMIT = 300.0
"""Time limit in seconds of wall time for the grader to make a build."""


class OwnBuilds(Builds):
    """Makes builds in the cache or, in a graded notebook, requests them from the grader.

    A build does not write to the workspace, and does not use earlier results in its ``install`` folder.
    """

    def __init__(self) -> None:
        super().__init__(cache.root(), PlainJobs(os.environ, handed_in=False))

    def build(
        self,
        found: Build,
        targets: Targets | None,
        *,
        name: str = WORKSPACE,
        cancelled: Callable[[], bool] = lambda: False,
    ) -> Build:
        """Build the needed packages. A build that took too long is returned like a failed one."""
        try:
            return super().build(found, targets, name=name, cancelled=cancelled)
        except BuildTookTooLong as error:
            return error.build

    def _make(self, found: Build, order: BuildOrder, entry: cache.CachedBuild) -> Build:
        socket = os.environ.get(GRADERS)
        asked = _ask(socket, found, order.packages, entry.folder / "install") if socket else None
        return asked or super()._make(found, order, entry)


class StudentsBuilds(OwnBuilds):
    """Finds builds for a student's own check: the student's build if it is up to date, else a new one.

    If sources were changed since the student's build, the check builds the changed sources, because students hand in
    only sources, and the grader of a class builds these. The card then names the changed files.
    """

    def _find_or_make(self, found: Build, chosen: Sequence[Package], order: BuildOrder) -> Build:
        if order.name != WORKSPACE:
            return super()._find_or_make(found, chosen, order)
        if is_current(found.workspace, chosen):
            names = tuple(package.name for package in chosen)
            return replace(found, ok=True, install=found.workspace / "install", chosen=names, reused=True)
        made = super()._find_or_make(found, chosen, order)
        return replace(made, changed=changed_since(found.workspace, chosen))


def _ask(socket: str, found: Build, chosen: Iterable[Package], install: Path) -> Build | None:
    """Request a build of packages from the grader.

    Args:
        socket: The path of the grader's socket.
        found: The workspace, as :func:`autograder.workspaces.builds.colcon.look` returns it.
        chosen: The packages.
        install: The folder to create for the build. It must not exist yet.

    Returns:
        The build, with paths that fit its new install folder; None if the grader does not answer, or refuses.
    """
    try:
        collected = collect_workspace(found.workspace)
        lines = Lines.to(socket, LIMIT)
    except (BadSources, Hangup):
        return None
    with contextlib.closing(lines), contextlib.suppress(Hangup, NotUnderstood, artefacts.BadArtefacts):
        top = found.workspace.resolve().name
        lines.say(messages.BuildRequest(len(collected), top, [package.name for package in chosen]))
        for source in collected:
            lines.say(source)
        answer: messages.BuildAnswer = lines.hear(messages.BuildAnswer)
        if isinstance(answer, messages.BuildFailed):
            return replace(
                found,
                seconds=answer.seconds,
                trouble=answer.trouble,
                package=answer.package,
                line=answer.line,
                log=answer.log,
            )
        if isinstance(answer, messages.BuildDone):
            archive = b"".join(lines.hear(messages.Piece).data for _ in range(answer.pieces))
            artefacts.unpack(archive, install)
            rename_paths(install, answer.install, str(install))
            return replace(found, ok=True, install=install, seconds=answer.seconds)
    return None
