"""Finds the real ros2cli, which takes precedence if it is installed."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping

# Every `ros2` that `install` writes contains this text, so that none of them starts another one.
OWN_MARK = b".ros2_command"
_HEAD = 1024  # the number of bytes to read of a script: the name of what it starts comes well before this


def find_real_command(environ: Mapping[str, str]) -> Path | None:
    """Return the path of the `ros2` of the ROS installation in use; None if it has none.

    The real one is on PATH, is not the course's own, and belongs to a prefix of AMENT_PREFIX_PATH. A `ros2` of
    another distribution that is on PATH by chance would not fit this process's libraries.
    """
    prefixes = environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep)
    for folder in environ.get("PATH", "").split(os.pathsep):
        candidate = Path(folder or ".", "ros2")
        try:
            with candidate.open("rb") as file:
                own = OWN_MARK in file.read(_HEAD)
        except OSError:
            continue
        if not own and str(candidate.parent.parent) in prefixes and os.access(candidate, os.X_OK):
            return candidate
    return None


def run_real_command() -> None:
    """Become the real `ros2` if there is one; otherwise return."""
    real = find_real_command(os.environ)
    if real is not None:
        os.execv(real, [str(real), *sys.argv[1:]])
