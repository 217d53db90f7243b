"""Shortens time limits after a student's function or class has hung.

If a student's function has an endless loop, each cell that uses the function hangs, and each would take its whole time
limit. So only the first such cell gets its full limit, later ones a short one. A function is blamed for a hang only if
the cell that hung is a cell of the master (which ends with every right answer) and uses nothing else that the student
defined. A check is never left out: if it reaches its verdict within the short limit, the verdict counts as usual.
"""

from __future__ import annotations

import ast
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from autograder.execution.cells import Cell, CellType

if TYPE_CHECKING:
    from collections.abc import Iterable

    from autograder.boxes.limits import Limits

AGAIN_SECONDS = 10.0
"""Time limit in seconds for a cell without points that uses a function or class that hung before."""
_SHARE_OF_A_CHECK = 0.25
"""The fraction of the judge's time limit that a check gets if an earlier check of the same class or function hung. This
is enough, because a check normally takes a twentieth of the limit.
"""


@dataclass
class Hangs:
    """The functions and classes of a student that have hung so far in a notebook.

    Args:
        written: The names of the classes and functions that the student defined.
    """

    written: frozenset[str]
    _hung: dict[str, str] = field(default_factory=dict)

    @classmethod
    def of(cls, cells: Iterable[Cell]) -> Hangs:
        """Return a record for the notebook with these cells, in which nothing has hung yet."""
        own = (cell.source for cell in cells if cell.kind is CellType.CODE and cell.own)
        return cls(frozenset(name for source in own for name in _defined(source)))

    def note(self, cell: Cell, title: str) -> None:
        """Record that a cell was stopped at its time limit.

        Args:
            cell: The cell.
            title: The title of the cell in messages.
        """
        used = [] if cell.own else self._used(cell)
        if len(used) == 1:
            self._hung.setdefault(used[0], title)

    def before(self, cell: Cell) -> tuple[str, str] | None:
        """Return the name of a function or class that hung before and that the cell uses; None if there is none.

        The second value is the title of the cell in which this function or class hung.
        """
        if not self._hung:
            return None  # nothing has hung, as in nearly every notebook, so no cell has to be parsed
        return next(((name, self._hung[name]) for name in self._used(cell) if name in self._hung), None)

    def _used(self, cell: Cell) -> list[str]:
        tree = _parsed(cell.source)
        names = {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)} if tree else set()
        return sorted(names & self.written)


def seconds_again(cell: Cell, usual: float, limits: Limits) -> float:
    """Return the time limit, in seconds of wall time, for a cell that uses a function or class that hung before.

    Args:
        cell: The cell.
        usual: The limit for any other cell.
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
    """Return the syntax tree of Python code; None for anything else: a magic, a syntax error, or unreadable text."""
    try:
        return ast.parse(source)
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return None
