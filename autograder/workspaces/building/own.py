"""Build a workspace of one's own: in a notebook or a terminal, as the student, on the student's own computer."""

from __future__ import annotations

import os
import shutil
import sys
from typing import TYPE_CHECKING

from autograder.workspaces.building import cache
from autograder.workspaces.building.builds import Builds, BuildTookTooLong
from autograder.workspaces.jobs import Built
from autograder.workspaces.running.own_session import OwnSession
from autograder.workspaces.running.prefixes import without_workspaces

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from autograder.workspaces.building.colcon import Build, Targets
    from autograder.workspaces.jobs import BuildOrder

LIMIT = 300.0
"""Seconds of wall time in which colcon must have ended."""
GRADERS = "AUTOGRADER_BUILDS"
"""Names the socket of the grader's side in a graded notebook's environment."""


def build(found: Build, targets: Targets | None = None) -> Build:
    """Build packages of a workspace, each time as if for the first time.

    The result is in the cache, not in the workspace: what an earlier build left in ``install`` has no part in it. The
    workspace is not written to.

    Args:
        found: The workspace, looked at.
        targets: See :meth:`autograder.workspaces.building.builds.Builds.build`.
    """
    try:
        return _OwnBuilds(cache.root(), _Here(found.workspace)).build(found, targets)
    except BuildTookTooLong as error:
        return error.build


class _OwnBuilds(Builds):
    """Builds made in the cache itself; in a graded notebook those that its grader has made."""

    def _make(self, found: Build, order: BuildOrder, entry: cache.Entry) -> Build:
        if socket := os.environ.get(GRADERS):
            from autograder.workspaces.building import client  # not at every start of a check

            asked = client.ask(socket, found, order.packages, entry.folder / "install")
            if asked is not None:
                return asked
        return super()._make(found, order, entry)


class _Here:
    """Implements :class:`autograder.workspaces.jobs.Builder`.

    Args:
        workspace: What is in it is not found by the build.
    """

    def __init__(self, workspace: Path) -> None:
        self._environment = without_workspaces(os.environ, workspace)
        self._environment.pop("PYTHONDONTWRITEBYTECODE", None)  # setuptools warns of it in every log

    def place(self, name: str, entry: Path) -> Path:
        """The entry itself."""
        del name
        return entry

    def build(self, order: BuildOrder, command: Sequence[str], entry: cache.Entry) -> Built:
        """Build in the entry."""
        colcon = OwnSession(command, {**self._environment, **order.variables}, entry.folder)
        built = run(colcon, order, entry, LIMIT, sys.maxsize)
        for made in ("build", "log"):
            shutil.rmtree(entry.folder / made, ignore_errors=True)
        return built


def run(colcon: OwnSession, order: BuildOrder, entry: cache.Entry, seconds: float, size: int) -> Built:
    """Follow colcon to its end.

    Args:
        colcon: The process.
        order: What is built.
        entry: Where it comes to.
        seconds: Wall time that it has.
        size: Bytes of its output that are kept.
    """
    with colcon:
        entry.built_by(colcon.pid)
        output, late = colcon.collect(seconds, size, order.cancelled)
        return Built(colcon.exit_code(), output, late=seconds if late else 0.0)
