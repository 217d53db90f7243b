"""The mutation operators: small functions from a program to the edits that make its mutants."""

from __future__ import annotations

from typing import TYPE_CHECKING

from tests.mutation.operators import lines, names, reports, statements, values, waiting

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from tests.mutation.code import Code, Edit

PYTHON: Sequence[Callable[[Code], Iterator[Edit]]] = (
    *names.OPERATORS,
    *values.OPERATORS,
    *statements.OPERATORS,
    *waiting.OPERATORS,
    *reports.OPERATORS,
)
"""For programs."""
LINES: Sequence[Callable[[str], Iterator[Edit]]] = lines.OPERATORS
"""For files that are no Python."""
