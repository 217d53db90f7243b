"""What each file imports, read from its syntax tree."""

from __future__ import annotations

import ast
import functools
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path


@dataclass(frozen=True)
class Import:
    """A name that a file imports.

    Attributes:
        line: The line of the statement.
        level: The number of dots of a relative import; 0 if the name is full.
        name: The name behind the dots.
        alias: The name by which the file calls it.
        means: What the alias stands for: ``os`` after ``import os.path``, else the name.
        for_types: Whether it is imported for types alone, and does not run.
        at_start: Whether it runs when the file itself is imported.
    """

    line: int
    level: int
    name: str
    alias: str
    means: str
    for_types: bool
    at_start: bool

    def full(self, name: str, module: str, *, is_package: bool) -> str:
        """Return a name of this import without dots in front, if the import is in this module."""
        package = module.split(".") if is_package else module.split(".")[:-1]
        return ".".join([*(package[: len(package) - self.level + 1] if self.level else []), name])


def imports_in(tree: ast.AST) -> tuple[Import, ...]:
    """Return the imports in a syntax tree, whether at the top or inside a function."""
    for_types = {
        id(inner)
        for node in ast.walk(tree)
        if isinstance(node, ast.If) and ast.unparse(node.test).endswith("TYPE_CHECKING")
        for statement in node.body
        for inner in ast.walk(statement)
    }
    functions = (ast.FunctionDef, ast.AsyncFunctionDef, ast.Lambda)
    later = {id(inner) for node in ast.walk(tree) if isinstance(node, functions) for inner in ast.walk(node)}
    found = []
    for node in ast.walk(tree):
        if isinstance(node, ast.Import | ast.ImportFrom):
            above = f"{node.module}." if isinstance(node, ast.ImportFrom) and node.module else ""
            level = node.level if isinstance(node, ast.ImportFrom) else 0
            for one in node.names:
                first = one.name if isinstance(node, ast.ImportFrom) else one.name.partition(".")[0]
                means = above + (one.name if one.asname else first)
                when = id(node) in for_types, id(node) not in later
                found.append(Import(node.lineno, level, above + one.name, one.asname or first, means, *when))
    return tuple(found)


@functools.cache
def imports_of(path: Path) -> tuple[Import, ...]:
    """Return the imports of a file, whether at the top or inside a function."""
    return imports_in(ast.parse(path.read_text(encoding="utf-8")))
