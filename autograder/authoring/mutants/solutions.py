"""The solution of an exercise as a program, and which of its lines are the student's."""

from __future__ import annotations

import ast
from dataclasses import dataclass
from typing import TYPE_CHECKING

from autograder.authoring.mutants.code import Code
from autograder.authoring.reference_files import CannotRecord, reference_solution
from autograder.masters.code_cells import BEGIN, END

if TYPE_CHECKING:
    from collections.abc import Iterator

_CHECK = "autograder.notebook"
"""The package that a notebook imports for checks and pictures, which no solution needs."""


@dataclass(frozen=True)
class Solution:
    """The solution of an exercise.

    Attributes:
        exercise: The exercise's id.
        text: The program: the class or function, and everything that it needs.
        root: The name of the class or function that is judged.
        own: The offsets in ``text`` at which the student's lines begin and end.
    """

    exercise: str
    text: str
    root: str
    own: tuple[tuple[int, int], ...]

    def is_own(self, start: int) -> bool:
        """Return True if a place in the text is in one of the student's lines."""
        return any(begin <= start < end for begin, end in self.own)


def solution(exercise_id: str) -> Solution | None:
    """Return the solution of an exercise; None if it is files on the disk, or no master has it."""
    try:
        found = reference_solution(exercise_id)
    except CannotRecord:
        return None
    if not found.subject.isidentifier():
        return None
    text = needed(found.source, found.subject)
    return Solution(exercise_id, text, found.subject, tuple(_regions(text, found.own)))


def needed(text: str, root: str) -> str:
    """Return the statements of a module that a class or function of it needs, with the imports, as they are written."""
    code = Code(text, subject=root)
    kept = code.wanted()
    names = {node.id for statement in kept for node in ast.walk(statement) if isinstance(node, ast.Name)}
    lines = text.splitlines(keepends=True)
    pieces = []
    for statement, following in zip(code.tree.body, [*code.tree.body[1:], None], strict=True):
        is_import = isinstance(statement, (ast.Import, ast.ImportFrom)) and bool(_made(statement) & names)
        if is_import or statement in kept:
            end = _first_line(following) - 1 if following else len(lines)
            # Comments at the end of an indented block belong to it: one of them closes the student's lines.
            last = statement.end_lineno or 0
            while last < end and (lines[last].startswith(" ") or not lines[last].strip()):
                last += 1
            pieces.append("".join(lines[_first_line(statement) - 1 : last]).rstrip() + "\n")
    return "\n".join(pieces)


def _first_line(statement: ast.stmt) -> int:
    return min([statement.lineno, *(one.lineno for one in getattr(statement, "decorator_list", []))])


def _made(statement: ast.Import | ast.ImportFrom) -> set[str]:
    if isinstance(statement, ast.ImportFrom) and str(statement.module).startswith(_CHECK):
        return set()
    return {alias.asname or alias.name.partition(".")[0] for alias in statement.names}


def _regions(text: str, cells: tuple[str, ...]) -> Iterator[tuple[int, int]]:
    """Yield the offsets at which the student's lines of these cells begin and end."""
    for cell in cells:
        before, begin, rest = cell.partition(BEGIN)
        inside, end, _ = rest.partition(END)
        region = f"{begin}{inside}{end}"
        # A class of the same text in another cell does not exist: its first lines differ.
        after_head = text.find(before.lstrip("\n").splitlines()[0] if before.strip() else region)
        start = text.find(region, max(0, after_head))
        if begin and end and start >= 0:
            yield start, start + len(region)
