"""Hangs in a student's code: waited for once at full length, and only a little after that.

A class with an endless loop hangs in each cell that uses it, and each of them would wait its whole limit again. Which
name it is can be told where a cell of the master's, which comes to its end with any right answer, uses exactly one name
that the student has defined. Where it uses several, or the student wrote the cell, nobody is blamed. A check is never
left out: one that comes to its verdict as fast as usual counts as usual.
"""

from __future__ import annotations

import ast
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from autograder.boxes.execution import Cell, CellType

if TYPE_CHECKING:
    from collections.abc import Iterable

    from autograder.boxes.limits import Limits

AGAIN_SECONDS = 10.0
"""Seconds for a cell without points that uses what has hung before."""
_SHARE_OF_A_CHECK = 0.25
"""Share of the judge's limit for a check of what has hung before; a check takes about a twentieth of that limit."""


@dataclass
class Hangs:
    """Names that have hung so far in a notebook.

    Args:
        written: The classes and functions that the student has defined.
    """

    written: frozenset[str]
    _hung: dict[str, str] = field(default_factory=dict)

    @classmethod
    def of(cls, cells: Iterable[Cell]) -> Hangs:
        """For these cells."""
        own = (cell.source for cell in cells if cell.kind is CellType.CODE and cell.own)
        return cls(frozenset(name for source in own for name in _defined(source)))

    def note(self, cell: Cell, title: str) -> None:
        """A cell was stopped at its limit.

        Args:
            cell: The cell.
            title: What it is called in messages.
        """
        used = [] if cell.own else self._used(cell)
        if len(used) == 1:
            self._hung.setdefault(used[0], title)

    def before(self, cell: Cell) -> tuple[str, str] | None:
        """The name in a cell that has hung before, and the title of the cell in which it did."""
        if not self._hung:
            return None  # as in nearly every notebook: no cell has to be parsed
        return next(((name, self._hung[name]) for name in self._used(cell) if name in self._hung), None)

    def _used(self, cell: Cell) -> list[str]:
        tree = _parsed(cell.source)
        names = {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)} if tree else set()
        return sorted(names & self.written)


def seconds_again(cell: Cell, usual: float, limits: Limits) -> float:
    """The limit of a cell that uses what has hung before, in seconds of wall time.

    Args:
        cell: The cell.
        usual: How long it may take where nothing it uses has hung.
        limits: All limits.
    """
    if cell.check is None or cell.check.asserts:
        return min(usual, AGAIN_SECONDS)
    return min(usual, cell.check.limit * _SHARE_OF_A_CHECK + limits.check_margin)


def _defined(source: str) -> list[str]:
    tree = _parsed(source)
    kinds = (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)
    return [node.name for node in tree.body if isinstance(node, kinds)] if tree else []


def _parsed(source: str) -> ast.Module | None:
    """Python, or None for what is none: a magic, a mistake, or text that nobody can read."""
    try:
        return ast.parse(source)
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return None
