"""The grader's side of builds that graded notebooks ask for; see :mod:`autograder.workspaces.building.client`."""

from __future__ import annotations

import io
import tarfile
from typing import TYPE_CHECKING

from autograder.messages.lines import NotUnderstood
from autograder.messages.workspaces import Build, BuildDone, BuildFailed, NotBuilt, Piece
from autograder.workspaces.building.builds import BuildTookTooLong
from autograder.workspaces.building.colcon import look
from autograder.workspaces.sources.collecting import receive
from autograder.workspaces.sources.finding import WORKSPACE
from autograder.workspaces.sources.tree import BadSources

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from autograder.messages.lines import Lines
    from autograder.workspaces.building.trusted import TrustedBuilds

PIECE = 400_000
"""Bytes of an archive in one message."""
_TREE = "workspace"


def serve_builds(lines: Lines, builds: TrustedBuilds, folder: Path, cancelled: Callable[[], bool]) -> None:
    """Answer one notebook's wish for a build.

    Args:
        lines: The notebook's end.
        builds: The cache.
        folder: Empty, ours alone.
        cancelled: Says when the notebook's time is up.

    Raises:
        Hangup: The notebook is gone.
    """
    tree = folder / _TREE
    tree.mkdir()
    try:
        order = lines.hear(Build)
        receive(lines, order.count, order.path, tree)
    except (BadSources, NotUnderstood) as error:
        lines.say(NotBuilt(str(error)))
        return
    found = look(tree / order.path)
    made = found
    if not found.trouble:
        try:
            made = builds.build(
                found,
                lambda f: [p.name for p in f.packages if p.name in order.only],
                cancelled=cancelled,
            )
        except BuildTookTooLong as error:
            made = error.build
    if not made.ok or made.install is None:
        told = (text.replace(f"{tree}/", "") for text in (made.trouble, made.package, made.line, made.log))
        lines.say(BuildFailed(made.seconds, *told))
        return
    archive = _archive(made.install)
    pieces = [archive[at : at + PIECE] for at in range(0, len(archive), PIECE)]
    place = builds.place(WORKSPACE, made.install.parent) / "install"
    lines.say(BuildDone(len(pieces), str(place), made.seconds, made.reused))
    for piece in pieces:
        lines.say(Piece(piece))


def _archive(install: Path) -> bytes:
    file = io.BytesIO()
    with tarfile.open(fileobj=file, mode="w") as tar:
        tar.add(install, arcname=".")
    return file.getvalue()
