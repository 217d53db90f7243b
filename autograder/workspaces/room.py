"""A limit that files of a student's have in common: each may be small, and all of them together far too much."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path


class Room:
    """Bytes of files that may still be looked into.

    Args:
        size: Bytes of all together.

    Attributes:
        sufficed: Whether there was room for every file until now.
    """

    def __init__(self, size: int) -> None:
        self._left = size
        self.sufficed = True

    def has(self, file: Path) -> bool:
        """True if there is room for a file, which takes it then. One that is not there takes none."""
        try:
            size = file.stat().st_size
        except OSError:
            size = 0
        if size > self._left:
            self.sufficed = False
            return False
        self._left -= size
        return True
