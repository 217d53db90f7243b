"""Definitions of a notebook, copied into the program that is made of them.

A program of a package repeats what the student wrote in the cells above. A master says so instead of repeating it, so
that the two cannot differ::

    ### BEGIN SOLUTION
    # TODO: copy your class TalkerNode here.
    ### COPY TalkerNode
    ### END SOLUTION
"""

from __future__ import annotations

import ast
import dataclasses
import re
from typing import TYPE_CHECKING

from autograder.masters.magics import has_magic
from autograder.masters.master_errors import CellError, MasterError
from autograder.masters.parsing import Cell, CellRole
from autograder.masters.regions import find_region

if TYPE_CHECKING:
    from pathlib import Path

COPY = re.compile(r"^### COPY (?P<names>\w+(?: \w+)*)$", re.MULTILINE)


def with_copies(master: Path, cells: list[Cell]) -> list[Cell]:
    """The cells, with what is copied in the place of the lines that say so.

    Args:
        master: Where the cells come from.
        cells: As they were parsed.

    Raises:
        MasterError: What is to be copied is not defined above.
    """
    defined: dict[str, str] = {}
    result = []
    for cell in cells:
        if cell.kind not in (CellRole.TEXT, CellRole.MANUAL) and COPY.search(cell.source):
            cell = _copied(master, cell, defined)
        elif cell.kind in (CellRole.SOLUTION, CellRole.GIVEN) and not has_magic(cell.source):
            defined |= _definitions(cell)
        result.append(cell)
    return result


def _copied(master: Path, cell: Cell, defined: dict[str, str]) -> Cell:
    def copy(line: re.Match[str]) -> str:
        names = line["names"].split()
        for name in names:
            if name not in defined:
                number = cell.body_line + cell.source.count("\n", 0, line.start())
                remedy = f"Defined so far: {', '.join(defined) or 'nothing'}."
                raise MasterError(
                    master, number, f"'{name}' is to be copied and is not defined above.", remedy
                )
        return "\n\n\n".join(defined[name] for name in names)

    return dataclasses.replace(cell, source=COPY.sub(copy, cell.source))


def _definitions(cell: Cell) -> dict[str, str]:
    """The functions, classes and constants of a cell, with their solutions, by their names."""
    source = cell.source
    try:
        if cell.kind is CellRole.SOLUTION:
            region = find_region(source)
            source = "\n".join((*region.before, *region.answer, *region.after))
        body = ast.parse(source).body
    except (CellError, SyntaxError):
        return {}  # said elsewhere, with the line
    lines = source.split("\n")
    found = {}
    for node in body:
        text = "\n".join(lines[node.lineno - 1 : node.end_lineno])
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)):
            found[node.name] = text
        elif isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
            found[node.targets[0].id] = text
    return found
