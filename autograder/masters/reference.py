"""The reference solution of an exercise as a program text, taken out of its master."""

from __future__ import annotations

import ast
from dataclasses import dataclass
from typing import TYPE_CHECKING

from autograder.masters.checks import exercise_points
from autograder.masters.errors import MasterError
from autograder.masters.parsing import Cell, Kind
from autograder.masters.source import Points, named_cells

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

DEFINITIONS = (ast.Import, ast.ImportFrom, ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)


@dataclass(frozen=True)
class Reference:
    """A reference solution.

    Attributes:
        source: Python that defines ``subject`` when it is executed, and does nothing else.
        subject: The name of the class or function that the check cell judges.
    """

    source: str
    subject: str


def reference_source(master: Path, exercise: str, *, points: Points = exercise_points) -> Reference:
    """What a notebook has defined when it comes to the check of ``exercise``.

    Solution cells are kept whole. Of given cells only imports, functions, classes and constants are kept: the
    rest demonstrates.

    Raises:
        MasterError: The master cannot be used, or has no check of ``exercise``.
    """
    parts: list[str] = []
    for named in named_cells(master, points=points):
        if named.check is not None and named.check.exercise == exercise:
            return Reference("\n\n".join(parts) + "\n", named.check.subject)
        if named.cell.kind is Kind.SOLUTION:
            parts.append(named.cell.source)
        elif named.cell.kind is Kind.GIVEN:
            parts.extend(_definitions(named.cell))
    raise MasterError(master, None, f"No cell checks '{exercise}'.", f'Write one: check("{exercise}", …).')


def _definitions(cell: Cell) -> Iterator[str]:
    lines = cell.source.split("\n")
    for node in ast.parse(cell.source).body:
        if isinstance(node, DEFINITIONS) or _is_constant(node):
            decorators = getattr(node, "decorator_list", [])
            first = min([node.lineno, *(decorator.lineno for decorator in decorators)])
            yield "\n".join(lines[first - 1 : node.end_lineno])


def _is_constant(node: ast.stmt) -> bool:
    """Whether it names a value and calls nothing: what a definition further down may need."""
    if not isinstance(node, (ast.Assign, ast.AnnAssign)):
        return False
    targets = node.targets if isinstance(node, ast.Assign) else [node.target]
    if not all(isinstance(target, ast.Name) for target in targets):
        return False
    return not any(isinstance(inner, (ast.Call, ast.Await)) for inner in ast.walk(node))
