"""Builds that a graded notebook asks its grader for, instead of making them in its own box.

What `colcon build` makes depends on the sources alone, so it need not be made a second time for the check, nor for
another student with the same sources. The box gets it as an archive and sees nothing of the cache that it comes from.
"""

from __future__ import annotations

import contextlib
from dataclasses import replace
from typing import TYPE_CHECKING

from autograder.messages.lines import Hangup, Lines, NotUnderstood
from autograder.messages.workspaces import Build as BuildOrder
from autograder.messages.workspaces import BuildAnswer, BuildDone, BuildFailed, Piece
from autograder.workspaces.building import artefacts
from autograder.workspaces.sources import collecting
from autograder.workspaces.sources.tree import BadSources

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from autograder.workspaces.building.colcon import Build
    from autograder.workspaces.sources.packages import Package

LIMIT = 300.0
"""Seconds of wall time that the grader may take for a build."""


def ask(socket: str, found: Build, chosen: Iterable[Package], install: Path) -> Build | None:
    """Let the grader build packages of a workspace.

    Args:
        socket: The grader's.
        found: The workspace, looked at.
        chosen: The packages.
        install: Where the build is put; not there yet.

    Returns:
        The build, with its install folder's own path in it wherever it names itself; None where nobody answers, or
        does not want to.
    """
    try:
        collected = collecting.collect_workspace(found.workspace)
        lines = Lines.to(socket, LIMIT)
    except (BadSources, Hangup):
        return None
    with contextlib.closing(lines), contextlib.suppress(Hangup, NotUnderstood, artefacts.BadArtefacts):
        top = found.workspace.resolve().name
        lines.say(BuildOrder(len(collected), top, [package.name for package in chosen]))
        for source in collected:
            lines.say(source)
        answer: BuildAnswer = lines.hear(BuildAnswer)
        if isinstance(answer, BuildFailed):
            return replace(
                found,
                seconds=answer.seconds,
                trouble=answer.trouble,
                package=answer.package,
                line=answer.line,
                log=answer.log,
            )
        if isinstance(answer, BuildDone):
            archive = b"".join(lines.hear(Piece).data for _ in range(answer.pieces))
            artefacts.unpack(archive, install)
            artefacts.rename_paths(install, answer.install, str(install))
            return replace(found, ok=True, install=install, seconds=answer.seconds, reused=answer.reused)
    return None
