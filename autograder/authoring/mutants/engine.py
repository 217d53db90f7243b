"""Makes the mutants of a program, each with one likely mistake, made once or in all places of a method."""

from __future__ import annotations

import ast
import hashlib
from collections import Counter
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from autograder.authoring.mutants.operators import PYTHON

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Sequence

    from autograder.authoring.mutants.code import Code, Edit

Change = tuple[str, "Edit"]
"""The name of an operator, and what it changes."""


@dataclass(frozen=True)
class Mutant:
    """A program with one mistake.

    Attributes:
        key: The operator, and a hash of what is changed, such as ``"number:1c9d02aa"``. Other edits of the program
            leave it as it is.
        operator: The name of the operator, a function in :mod:`autograder.authoring.mutants.operators`.
        kind: Which of several things the operator did, such as ``"times 0.5"``; empty if it does only one.
        line: The number of the changed line, from 1.
        where: The definitions around the change, such as ``"TalkerNode.__init__"``.
        start: The offset of the changed place in the program.
        before: What stands there in the program.
        after: What stands there in the mutant.
        all_of: The number of places of a method in which the same mistake is made.
        text: The whole mutant.
    """

    key: str
    operator: str
    kind: str
    line: int
    where: str
    start: int
    before: str
    after: str
    all_of: int
    text: str


def python_changes(code: Code) -> list[Change]:
    """Return everything that the operators change in a program."""
    return [(operator.__name__, edit) for operator in PYTHON for edit in operator(code)]


def in_all_places(changes: Iterable[Change]) -> Iterator[Change]:
    """Yield changes of which each makes the same mistake in all places of one method."""
    groups: dict[tuple[str, str, str], list[Edit]] = {}
    for operator, edit in changes:
        if edit.kind and not edit.also:
            groups.setdefault((operator, edit.kind, edit.where), []).append(edit)
    for (operator, _, _), edits in groups.items():
        apart: list[Edit] = []
        for edit in sorted(edits, key=lambda one: one.start):
            if not apart or edit.start >= apart[-1].end:
                apart.append(edit)
        if len(apart) > 1:
            yield operator, replace(apart[0], also=tuple(apart[1:]))


def meaning(text: str) -> str | None:
    """Return what a program means to Python, however it is written; None if it is not valid Python."""
    try:
        return ast.dump(ast.parse(text))
    except SyntaxError:
        return None


def mutants(
    text: str, changes: Sequence[Change], means: Callable[[str], str | None] = meaning
) -> list[Mutant]:
    """Return the mutants of a program in the order of its text. No two of them mean the same.

    Args:
        text: The program.
        changes: What is changed in each mutant.
        means: Returns what a text means; None if it means nothing.
    """
    seen = {means(text)}
    counts: Counter[str] = Counter()
    found = []
    for operator, edit in sorted(changes, key=lambda change: (bool(change[1].also), change[1].start)):
        mutated = edit.applied(text)
        meant = means(mutated)
        if meant is None or meant in seen:
            continue
        seen.add(meant)
        changed = "\n".join(_changed(text, piece) for piece in edit.pieces)
        key = f"{operator}:{hashlib.sha256(changed.encode()).hexdigest()[:8]}"
        counts[key] += 1
        found.append(
            Mutant(
                key=key + (f".{counts[key]}" if counts[key] > 1 else ""),
                operator=operator,
                kind=edit.kind,
                line=text.count("\n", 0, edit.start) + 1,
                where=edit.where,
                start=edit.start,
                before=text[edit.start : edit.end],
                after=edit.text,
                all_of=1 + len(edit.also) * bool(edit.kind),
                text=mutated,
            )
        )
    return found


def _changed(text: str, edit: Edit) -> str:
    return f"{edit.where}\n{_lines(text, edit)}\n{text[edit.start : edit.end]}\n{edit.text}"


def _lines(text: str, edit: Edit) -> str:
    """Return the whole lines around an edit, without their indentation."""
    start = text.rfind("\n", 0, edit.start) + 1
    end = text.find("\n", edit.end)
    return text[start : end if end >= 0 else None].strip()
