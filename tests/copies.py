"""Copies of the course's folders, for tests that change a file."""

from __future__ import annotations

import shutil
from pathlib import Path

# Hidden files belong to the clone, and while a test of the boxes runs, some hold a planted secret and go away again.
LEFT_OUT = (".*", "__pycache__", "build", "install", "log", "*.egg-info")


def copied(folder: Path, to: Path, *left_out: str) -> Path:
    """Copy a folder of the clone without what was built there, and return the copy.

    Args:
        folder: A folder of the clone, or the clone.
        to: Where the copy is made.
        left_out: Patterns of names that are left out too.
    """
    return Path(shutil.copytree(folder, to, ignore=shutil.ignore_patterns(*LEFT_OUT, *left_out)))
