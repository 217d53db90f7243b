"""The reference solution of an exercise as a program text, taken out of its master."""

from __future__ import annotations

import ast
from dataclasses import dataclass
from typing import TYPE_CHECKING

from autograder.masters.check_cells import exercise_points
from autograder.masters.magics import has_magic, shell_script, written_file
from autograder.masters.master_errors import MasterError
from autograder.masters.parsing import Cell, CellRole
from autograder.masters.source import Points, named_cells

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

DEFINITIONS = (ast.Import, ast.ImportFrom, ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)


@dataclass(frozen=True)
class Reference:
    """A reference solution.

    Attributes:
        source: Python that makes ``subject`` when it is executed: defines it, or writes its files into the
            current folder.
        subject: As Python writes it: the name of the class or function that the check cell judges, or the
            path of what was made.
    """

    source: str
    subject: str


def reference_source(master: Path, exercise: str, *, points: Points = exercise_points) -> Reference:
    """The source of everything that a notebook has defined before the check of ``exercise``.

    Solution cells are kept whole. Of given cells only imports, functions, classes and constants are kept: the
    rest demonstrates. Files are written, and where the subject is a path the shell runs what is given to it:
    what is judged then is on the disk, and commands such as ``ros2 pkg create`` put it there.

    Raises:
        MasterError: The master cannot be used, or has no check of ``exercise``.
    """
    cells: list[Cell] = []
    for named in named_cells(master, points=points):
        if named.check is not None and named.check.exercise == exercise:
            parts = [part for cell in cells for part in _kept(cell, shell=named.check.is_path)]
            return Reference("\n\n".join(parts) + "\n", named.check.subject)
        cells.append(named.cell)
    raise MasterError(master, None, f"No cell checks '{exercise}'.", f'Write one: check("{exercise}", …).')


def _kept(cell: Cell, *, shell: bool) -> Iterator[str]:
    """The part of one cell that the program needs.

    Args:
        cell: Any cell above the check.
        shell: Whether shell cells are run.
    """
    if cell.kind not in (CellRole.SOLUTION, CellRole.GIVEN):
        return
    if has_magic(cell.source):
        yield from _on_disk(cell.source, shell=shell)
    elif cell.kind is CellRole.SOLUTION:
        yield cell.source
    else:
        yield from _definitions(cell)


def _on_disk(source: str, *, shell: bool) -> Iterator[str]:
    file, script = written_file(source), shell_script(source)
    if file is not None:
        yield (
            f"import pathlib\nfile = pathlib.Path({str(file.path)!r})\n"
            f"file.parent.mkdir(parents=True, exist_ok=True)\nfile.write_text({file.text!r})"
        )
    elif script is not None and shell:
        yield f"import subprocess\nsubprocess.run(['bash', '-c', {script!r}], check=False)"


def _definitions(cell: Cell) -> Iterator[str]:
    lines = cell.source.split("\n")
    for node in ast.parse(cell.source).body:
        if isinstance(node, DEFINITIONS) or _is_constant(node):
            decorators = getattr(node, "decorator_list", [])
            first = min([node.lineno, *(decorator.lineno for decorator in decorators)])
            yield "\n".join(lines[first - 1 : node.end_lineno])


def _is_constant(node: ast.stmt) -> bool:
    """True if it names a value and calls nothing: what a definition further down may need."""
    if not isinstance(node, (ast.Assign, ast.AnnAssign)):
        return False
    targets = node.targets if isinstance(node, ast.Assign) else [node.target]
    if not all(isinstance(target, ast.Name) for target in targets):
        return False
    return not any(isinstance(inner, (ast.Call, ast.Await)) for inner in ast.walk(node))
