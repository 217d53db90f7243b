"""The lines of an answer that its notebook has before the task: given ones, and those of an earlier task.

A mistake there is no answer to this task. An earlier task judges its own lines.
"""

from __future__ import annotations

import ast
from functools import cache
from typing import TYPE_CHECKING

from autograder.authoring.reference_files import CannotRecord, reference_solution

if TYPE_CHECKING:
    from collections.abc import Iterator

Place = tuple[str, str]
"""The definitions around a line, such as ``"Heart.on_beat"``, and the line without its indentation."""


def given_lines(exercise: str, text: str) -> set[int]:
    """The numbers of the lines, from 1, that stand in a definition of the same name in a cell before the task."""
    given = _given(exercise)
    return {number for number, place in enumerate(_places(text), start=1) if place in given}


@cache
def _given(exercise: str) -> frozenset[Place]:
    try:
        found = reference_solution(exercise)
    except CannotRecord:
        return frozenset()
    text = found.source
    for cell in found.own:
        text = text.replace(cell, "")
    return frozenset(place for place in _places(text) if place[1])


def _places(text: str) -> list[Place]:
    lines = text.splitlines()
    around = [""] * (len(lines) + 1)
    for name, definition in _definitions(ast.parse(text)):
        # An inner definition comes later, and replaces the outer name in its own lines.
        for number in range(definition.lineno, (definition.end_lineno or definition.lineno) + 1):
            around[number] = name
    return [(name, line.strip()) for name, line in zip(around[1:], lines, strict=True)]


def _definitions(tree: ast.AST, inside: str = "") -> Iterator[tuple[str, ast.stmt]]:
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef):
            name = f"{inside}.{node.name}".lstrip(".")
            yield name, node
            yield from _definitions(node, name)
