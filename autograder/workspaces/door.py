"""Builds that a graded notebook asks its grader for, instead of making them in its own box.

What `colcon build` makes depends on the sources alone, so it need not be made a second time for the check, nor for
another student with the same sources. The box gets it as an archive and sees nothing of the cache that it comes from.
"""

from __future__ import annotations

import base64
import contextlib
import io
import os
import tarfile
from dataclasses import replace
from typing import TYPE_CHECKING

from autograder.workspaces import artefacts, sources
from autograder.workspaces.finding import WORKSPACE
from autograder.workspaces.lines import Hangup, Lines

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable
    from pathlib import Path

    from autograder.workspaces.building import Build
    from autograder.workspaces.packages import Package
    from autograder.workspaces.trusted_build import TrustedBuilds

VARIABLE = "AUTOGRADER_BUILDS"
"""Names the door's socket in a graded notebook's environment."""
PIECE = 400_000
"""Bytes of an archive in one message."""
LIMIT = 300.0
"""Seconds of wall time that the grader may take for a build."""
_TREE = "workspace"


def ask(found: Build, chosen: Iterable[Package], install: Path) -> Build | None:
    """Let the grader build packages of a workspace.

    Args:
        found: The workspace, looked at.
        chosen: The packages.
        install: Where the build is put; not there yet.

    Returns:
        The build, with its install folder's own path in it wherever it names itself; None where nobody can be asked,
        or does not want to.
    """
    path = os.environ.get(VARIABLE)
    if not path:
        return None
    try:
        collected = sources.collect_workspace(found.workspace)
        lines = Lines.to(path, LIMIT)
    except (sources.BadSources, Hangup):
        return None
    with contextlib.closing(lines), contextlib.suppress(Hangup, artefacts.BadArtefacts, KeyError, ValueError):
        top = found.workspace.resolve().name
        lines.say("build", count=len(collected), path=top, only=[package.name for package in chosen])
        for source in collected:
            lines.say("source", **source.as_words())
        answer = lines.hear()
        if answer["say"] == "failed":
            return replace(
                found,
                seconds=float(answer["seconds"]),
                trouble=str(answer["trouble"]),
                package=str(answer["package"]),
                line=str(answer["line"]),
                log=str(answer["log"]),
            )
        if answer["say"] == "built":
            pieces = [base64.b64decode(lines.hear()["data"]) for _ in range(int(answer["pieces"]))]
            artefacts.unpack(b"".join(pieces), install)
            artefacts.rename_paths(install, str(answer["install"]), str(install))
            return replace(
                found,
                ok=True,
                install=install,
                seconds=float(answer["seconds"]),
                reused=bool(answer["reused"]),
            )
    return None


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
    from autograder.workspaces.building import look
    from autograder.workspaces.trusted_build import BuildTookTooLong

    wish = lines.hear()
    tree = folder / _TREE
    tree.mkdir()
    try:
        if not 0 <= int(wish["count"]) <= sources.MAX_FILES:
            raise sources.BadSources("there is too much in src")
        taken = [sources.from_words(lines.hear()) for _ in range(int(wish["count"]))]
        sources.write(sources.checked(taken), tree)
        top = sources.checked([sources.Source(str(wish["path"]))])[0].path
        only = {str(name) for name in wish["only"]}
    except (sources.BadSources, KeyError, TypeError, ValueError) as error:
        lines.say("no", why=str(error))
        return
    found = look(tree / top)
    made = found
    if not found.trouble:
        try:
            made = builds.build(
                found,
                lambda f: [p.name for p in f.packages if p.name in only],
                name=WORKSPACE,
                cancelled=cancelled,
            )
        except BuildTookTooLong as error:
            made = replace(found, trouble="build", line=str(error), log=str(error))
    if not made.ok or made.install is None:
        told = {
            name: getattr(made, name).replace(f"{tree}/", "")
            for name in ("trouble", "package", "line", "log")
        }
        lines.say("failed", seconds=made.seconds, **told)
        return
    archive = _archive(made.install)
    pieces = [archive[at : at + PIECE] for at in range(0, len(archive), PIECE)]
    place = builds.place(WORKSPACE, made.install.parent) / "install"
    lines.say("built", pieces=len(pieces), install=str(place), seconds=made.seconds, reused=made.reused)
    for piece in pieces:
        lines.say("piece", data=base64.b64encode(piece).decode())


def _archive(install: Path) -> bytes:
    file = io.BytesIO()
    with tarfile.open(fileobj=file, mode="w") as tar:
        tar.add(install, arcname=".")
    return file.getvalue()
