"""Finds the lines of a student's code that use a name, such as ``publish``, so that a card can point at them.

The code is only read, never run, and only in a process of the student: a notebook's kernel, or for a program
``python -m autograder.own_lines FILE…``. The judge takes the result as a claim, which no point depends on.
"""

from __future__ import annotations

import ast
import functools
import sys
from collections import defaultdict
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

import msgspec

from autograder.messages.judge_messages import OwnLine, OwnLines

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

MOST_OF_A_NAME = 3
"""The maximum number of lines for each name in each source. A card shows at most two of them."""
MOST_NAMES = 500
"""The maximum number of names. If the code uses more, no lines are reported: a part could be taken for the whole."""
MOST_FILES = 30
"""The maximum number of files that are read in a workspace."""
LONGEST_SOURCE = 200_000
"""The maximum length of a source, in characters. Longer code is not read."""
LONGEST_LINE = 120
"""The maximum length of a quoted line, in characters."""
ENDLESS, UNLEFT = ", whose condition stays true", ", which no line leaves"
"""The words behind the quoted head of a loop that cannot end. A `while True` may be all that a program does."""
_LEAVES = ast.Break | ast.Return | ast.Raise | ast.Yield | ast.YieldFrom | ast.Await
_PLAIN = ast.BoolOp | ast.UnaryOp | ast.BinOp | ast.Compare | ast.Constant | ast.Name | ast.Attribute
"""What a condition may consist of if its names have plain values. Anything else, such as a call, may change alone."""


def own_lines(sources: Mapping[str, str]) -> OwnLines:
    """Return the lines that use a name, for each name that stands after a dot or is called.

    ``def tick`` and ``count =`` are names, too, of the lines that define the function and that set the variable.

    Args:
        sources: The student's code, by its place, such as ``your cell``. The first source defines what is checked.
            If this code calls a function of another one, as a tool, the line of the call counts as the line that uses
            what the tool uses: the tool may have been given, and the student may not have to change it.
    """
    lines: dict[str, list[OwnLine]] = defaultdict(list)
    for place, text in sources.items():
        tree = _parsed(text)
        tools = {name: list(found) for name, found in lines.items()}
        for statement in ast.walk(tree):
            if isinstance(statement, ast.FunctionDef) and statement.name in tools:
                for name in {name for name, _ in _uses(statement, text)} - set(tools):
                    lines[name] += [msgspec.structs.replace(one, name=name) for one in tools[statement.name]]
        for name, (number, quote) in _uses(tree, text):
            if sum(line.place == place for line in lines[name]) < MOST_OF_A_NAME:
                lines[name].append(OwnLine(name, place, number, quote))
    if len(lines) > MOST_NAMES:
        return OwnLines([])
    return OwnLines([line for found in lines.values() for line in found])


def _parsed(text: str) -> ast.Module:
    """Return the syntax tree of a source; an empty one if the source cannot be read: the card shows that error."""
    with suppress(SyntaxError, ValueError, RecursionError, MemoryError):
        return ast.parse(text if len(text) <= LONGEST_SOURCE else "")
    return ast.Module([], [])


def _uses(tree: ast.AST, text: str) -> Iterator[tuple[str, tuple[int, str]]]:
    """Yield each name that a statement uses, with the number and text of the line, in the order of the code."""
    lines = text.splitlines()
    statements = [one for one in ast.walk(tree) if isinstance(one, ast.stmt)]
    for statement in sorted(statements, key=lambda one: one.lineno):
        if isinstance(statement, ast.FunctionDef | ast.AsyncFunctionDef):
            yield f"def {statement.name}", (statement.lineno, _quote(lines[statement.lineno - 1 :][:1]))
        # The statements inside of this one, as in the body of a loop, come by themselves.
        own = [one for one in ast.iter_child_nodes(statement) if isinstance(one, ast.expr | ast.withitem)]
        used = [node for one in own for node in ast.walk(one)]
        end = max((node.end_lineno or 0 for node in used if isinstance(node, ast.expr)), default=0)
        quote = _quote(lines[statement.lineno - 1 : end])
        for name in dict.fromkeys(filter(None, map(_name, used))):
            yield name, (statement.lineno, quote)


@functools.lru_cache(
    maxsize=64
)  # a recursion has hundreds of calls at one line, and so has each of its threads
def loop_around(text: str, line: int, fixed: frozenset[str] = frozenset()) -> str:
    """Return the line number and the quoted head of the innermost loop around a line; empty if there is none.

    ``ENDLESS`` or ``UNLEFT`` follows if the loop cannot end.

    Args:
        text: The source.
        line: The number of a line in it, counted from 1.
        fixed: The variables and attributes that have plain values, such as a number, and that only this function sets.
    """
    tree = _parsed(text)
    statements = [one for one in ast.walk(tree) if isinstance(one, ast.stmt)]
    around = [one for one in statements if one.lineno <= line <= (one.end_lineno or 0)]
    loops = [one for one in around if isinstance(one, ast.While | ast.For | ast.AsyncFor)]
    if not loops:
        return ""
    inner = max(loops, key=lambda one: one.lineno)
    function = next((one for one in reversed(around) if isinstance(one, ast.FunctionDef)), tree)
    ends = _never_ends(inner, function, fixed) if isinstance(inner, ast.While) else ""
    return f"{inner.lineno}: {_quote(text.splitlines()[inner.lineno - 1 :][:1])}{ends}"


def _never_ends(loop: ast.While, function: ast.AST, fixed: frozenset[str]) -> str:
    """Return words if no line of a loop leaves it, or changes a name in its condition; else nothing."""
    if any(isinstance(node, _LEAVES) for node in ast.walk(loop)):
        return ""
    if isinstance(loop.test, ast.Constant):
        return UNLEFT if loop.test.value else ""
    parts = [one for one in ast.walk(loop.test) if isinstance(one, ast.expr)]
    owners = [one.value for one in parts if isinstance(one, ast.Attribute)]
    names = {
        ast.unparse(one) for one in parts if isinstance(one, ast.Name | ast.Attribute) and one not in owners
    }
    shares = any(isinstance(node, ast.Global | ast.Nonlocal) for node in ast.walk(function))
    is_plain = all(isinstance(one, _PLAIN) for one in parts) and not shares
    return ENDLESS if is_plain and names and names <= fixed - _set_in(loop) else ""


def _set_in(node: ast.AST) -> set[str]:
    names = (one for one in ast.walk(node) if isinstance(one, ast.Name | ast.Attribute))
    return {ast.unparse(one) for one in names if not isinstance(one.ctx, ast.Load)}


def _quote(lines: Sequence[str]) -> str:
    return " ".join(" ".join(lines).split())[:LONGEST_LINE]


def _name(node: ast.AST) -> str:
    if isinstance(node, ast.Attribute):
        return node.attr
    if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
        return f"{node.id} ="
    return node.func.id if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) else ""


def files_of(path: Path) -> list[Path]:
    """Return a Python file, or the first Python files of a workspace's packages."""
    return sorted(path.glob("src/**/*.py"))[:MOST_FILES] if path.is_dir() else [path]


def own_lines_of_files(paths: Iterable[Path]) -> OwnLines:
    """Return the lines of Python files and workspaces. A file that cannot be read has no lines."""
    sources = {}
    for file in (file for path in paths for file in files_of(path)):
        with suppress(OSError):
            sources[file.name] = file.read_text(encoding="utf-8", errors="replace")
    return own_lines(sources)


if __name__ == "__main__":
    sys.stdout.buffer.write(msgspec.json.encode(own_lines_of_files(map(Path, sys.argv[1:]))))
