"""Errors for authors whose master cannot be used."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path


class MasterError(Exception):
    """A master, or the folder of masters, cannot be used.

    Attributes:
        path: The path of the file or folder.
        line: The line, counted from 1; None for the whole file.
        problem: What is wrong, as a sentence.
        remedy: What to do about it, as a sentence.
    """

    def __init__(self, path: Path, line: int | None, problem: str, remedy: str) -> None:
        place = str(path) if line is None else f"{path}:{line}"
        super().__init__(f"{place}: {problem} {remedy}")
        self.path = path
        self.line = line
        self.problem = problem
        self.remedy = remedy


class CellError(ValueError):
    """A cell cannot be read. Code that knows the master turns this into a :class:`MasterError`.

    Attributes:
        offset: The line within the cell, counted from 0.
        problem: What is wrong, as a sentence.
        remedy: What to do about it, as a sentence.
    """

    def __init__(self, offset: int, problem: str, remedy: str) -> None:
        super().__init__(f"{problem} {remedy}")
        self.offset = offset
        self.problem = problem
        self.remedy = remedy

    def at(self, path: Path, body_line: int) -> MasterError:
        """Return the error for the master ``path``, given the line on which the text of the cell begins."""
        return MasterError(path, body_line + self.offset, self.problem, self.remedy)
