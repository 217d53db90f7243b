"""Remembers the classes that this user has made or named, because only there nbgrader may read the current folder.

nbgrader runs the ``nbgrader_config.py`` of the current folder, and imports modules from this folder. So in a folder
with a student's files, it would run the student's code with the rights of the instructor. Nothing inside a folder can
prove that the folder is a class of the instructor's own. So the user's data folder contains a file for each class.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import platformdirs

from autograder.command_name import COMMAND
from autograder.standard_output import printable

if TYPE_CHECKING:
    from collections.abc import Sequence

CONFIG_NAME = "nbgrader_config.py"


def remember(folder: Path) -> None:
    """Remember a class that the course has made, or that the user has named in a command."""
    mark = _mark(folder)
    with contextlib.suppress(OSError):  # without a writable home, nbgrader has to be told the file each time
        mark.parent.mkdir(parents=True, exist_ok=True)
        mark.touch()


def is_known(folder: Path) -> bool:
    """Return True if the folder is a class that was remembered."""
    return _mark(folder).is_file()


def reason_against(folder: Path, command: str, words: Sequence[str]) -> str:
    """Return why nbgrader or Jupyter must not start in a folder, and what to type; empty if it may.

    Args:
        folder: The current folder.
        command: ``"nbgrader"`` or ``"jupyter"``.
        words: The arguments of the command. If one of them names the configuration file, the user trusts the folder.
    """
    if is_known(folder) or any(word.endswith(CONFIG_NAME) for word in words):
        return ""
    return (
        f"{command} runs code from the current folder, and {folder} is not a class that a command of yours has made or "
        f"named. Go to the folder of your class. If it is this one, type {COMMAND} report '{folder}' first, or add "
        f"--config={CONFIG_NAME} to your command."
    )


def _mark(folder: Path) -> Path:
    name = hashlib.sha256(os.fsencode(folder.resolve())).hexdigest()
    return platformdirs.user_data_path("ros2-course") / "classes" / name


if __name__ == "__main__":
    why = reason_against(Path.cwd(), sys.argv[1], sys.argv[2:])
    sys.exit(printable(f"course: error: {why}") if why else 0)
