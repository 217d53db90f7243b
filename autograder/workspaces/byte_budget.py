"""A byte limit shared by a student's files: each file may be small, but all files together far too large."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path


class ByteBudget:
    """The number of bytes that may still be read from a set of files.

    Args:
        size: The maximum number of bytes for all files together.

    Attributes:
        sufficed: True if the budget was enough for every file so far.
    """

    def __init__(self, size: int) -> None:
        self._left = size
        self.sufficed = True

    def has(self, file: Path) -> bool:
        """Subtract the size of a file (0 if it is missing). If too little is left, return False instead."""
        try:
            size = file.stat().st_size
        except OSError:
            size = 0
        if size > self._left:
            self.sufficed = False
            return False
        self._left -= size
        return True
