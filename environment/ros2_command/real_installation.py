"""Where a real ros2cli is installed it is the one that runs."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping

# Stands in every `ros2` that `install` writes, so that one never hands over to another.
OWN_MARK = b"environment.ros2_command"
_HEAD = 1024  # bytes: a script names what it starts well before this


def find_real_command(environ: Mapping[str, str]) -> Path | None:
    """Return the first `ros2` on PATH that is not one of the course's own, or None."""
    for folder in environ.get("PATH", "").split(os.pathsep):
        candidate = Path(folder or ".", "ros2")
        try:
            with candidate.open("rb") as file:
                own = OWN_MARK in file.read(_HEAD)
        except OSError:
            continue
        if not own and os.access(candidate, os.X_OK):
            return candidate
    return None


def environment_of_real_command(environ: Mapping[str, str], own_prefix: str) -> dict[str, str]:
    """Return the environment without what only the wheels of `own_prefix` need.

    The libraries of two ROS installations must not meet in one process.
    """
    real = {name: value for name, value in environ.items() if name != "_ROS_WHEELS_BOOTSTRAP_COMPLETE"}
    libraries = [
        folder
        for folder in real.pop("LD_LIBRARY_PATH", "").split(os.pathsep)
        if folder and not folder.startswith(f"{own_prefix}/")
    ]
    if libraries:
        real["LD_LIBRARY_PATH"] = os.pathsep.join(libraries)
    return real


def run_real_command() -> None:
    """Become the real `ros2` if there is one; return otherwise."""
    real = find_real_command(os.environ)
    if real is None:
        return
    sys.stdout.flush()
    os.execve(real, [str(real), *sys.argv[1:]], environment_of_real_command(os.environ, sys.prefix))
